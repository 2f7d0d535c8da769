// SPDX-License-Identifier: BSD-3-Clause
// Reads and writes files. Every loader throws InputError: one line with file, key or row, what is
// wrong and what is allowed.
#pragma once
#include "swivel/io/files/files.hpp"
#include "swivel/io/meshes/mesh.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/io/motions/trajectory.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/io/results/given_answer.hpp"
#include "swivel/io/results/result.hpp"
#include "swivel/io/robots/robot.hpp"
#include "swivel/io/tables/campaign.hpp"
