#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws docs/figures/experiment_a.svg: the seven joints along the path of experiment A, by the Jacobian baseline and by Swivel.

experiment_a.py JACOBIAN.csv SWIVEL.csv URDF OUT.svg      (needs python3-matplotlib; commands in docs/figures/README.md)
"""
import csv
import sys
import xml.etree.ElementTree as ET

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "swivel"  # the same file from the same data
import matplotlib.pyplot as plt


def table(file):
    with open(file) as lines:
        rows = list(csv.DictReader(lines))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def main():
    jacobian, swivel, urdf, out = sys.argv[1:]
    limits = {}
    for joint in ET.parse(urdf).getroot().findall("joint"):
        if joint.find("limit") is not None:
            limits[joint.get("name")] = (float(joint.find("limit").get("lower")), float(joint.find("limit").get("upper")))
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.6), sharey=True)
    for axis, data, title in ((axes[0], table(jacobian), "Jacobian pseudo-inverse: stopped by a joint limit"), (axes[1], table(swivel), "Swivel: finishes, start chosen by the search")):
        for name in [n for n in data if n in limits]:
            low, high = limits[name]
            axis.plot(data["s"], [100 * (q - low) / (high - low) for q in data[name]], label=name.replace("arm_left_joint_", "joint "), linewidth=1.8)
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("s, m along the path")
        axis.set_xlim(0, 0.5)
        axis.set_ylim(-3, 103)
        for limit in (0, 100):
            axis.axhline(limit, color="black", linewidth=0.8, linestyle="--")
        axis.grid(alpha=0.25)
    stop = table(jacobian)["s"][-1]
    axes[0].axvline(stop, color="crimson", linewidth=1)
    axes[0].annotate(f"limit at {100 * stop / 0.5:.0f} % of the path", (stop, 55), xytext=(6, 0), textcoords="offset points", color="crimson", fontsize=9)
    axes[0].set_ylabel("joint, % of its range")
    figure.legend(*axes[1].get_legend_handles_labels(), loc="lower center", ncol=7, fontsize=8.5, frameon=False)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    figure.savefig(out, metadata={"Date": None})


main()
