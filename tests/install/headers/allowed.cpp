// SPDX-License-Identifier: BSD-3-Clause
#include <bits/stdc++.h>

#include <Eigen/Dense>
