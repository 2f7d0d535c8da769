# SPDX-License-Identifier: BSD-3-Clause
"""The arms of data/ for which problems are generated: their tools, and about which pose of the tool
they work well."""
import dataclasses
import math

from same import poses

DATA = "../data"  # as seen from the folder of generated problems


@dataclasses.dataclass(frozen=True)
class Arm:
    """An arm with a tool. `pose` is about where its tool works, in the base link (m); `spread` how
    far from there paths begin (m); `resolution` a coarse one; `home` joints that are clear of the
    work (rad; of a rail m)."""

    robot: dict
    pose: tuple
    spread: tuple
    resolution: dict
    home: list
    roll: object = None  # what `path.roll` may be, or nothing
    kind: str = "no arm angle"  # or "S-R-S", "S-R-S and a roll", "roll"
    part_below: float = 0.3  # m, how far below the paths the part stands

    @property
    def base(self):
        """The name of the base link, in which scene and paths are given."""
        return self.robot["base_link"]


def robot(name, tip, tool, attached, base="base_link", **more):
    """The section `robot` of a problem file; bodies are attached to `tip`."""
    return {
        "urdf": f"{DATA}/robots/{name}.urdf",
        "srdf": f"{DATA}/robots/{name}.srdf",
        "base_link": base,
        "tip_link": tip,
        "tool": tool,
        **more,
        "attached": [{**body, "link": tip} for body in attached],
    }


def capsule(name, radius, length, z):
    """A body about the z axis of its link."""
    return {"name": name, "capsule": {"radius": radius, "length": length}, "xyz": [0, 0, z]}


QUARTER = math.pi / 4
DOWN = poses.of_rpy(math.pi, 0, 0)
BENT = {"xyz": [0.06, 0, 0.22], "rpy": [0, QUARTER, 0]}
TORCH = [
    capsule("torch_body", 0.02, 0.11, 0.085),
    {
        "name": "torch_neck",
        "capsule": {"radius": 0.008, "length": 0.06},
        "xyz": [0.0211, 0, 0.1811],
        "rpy": [0, QUARTER, 0],
    },
]
ANGLE = {"ds": 0.02, "dphi": 0.2}
ARCS = {"ds": 0.02, "arc": 0.35}
STRAIGHT = {"xyz": [0, 0, 0.15]}

ARMS = {
    "iiwa": Arm(
        robot("iiwa14", "tool0", STRAIGHT, [capsule("nozzle", 0.02, 0.08, 0.065)]),
        ([0.55, 0.0, 0.2], DOWN),
        (0.1, 0.2, 0.1),
        ANGLE,
        [0.0, 0.4, 0.0, -1.4, 0.0, 1.3, 0.0],
        kind="S-R-S",
    ),
    "iiwa with a roll": Arm(
        robot("iiwa14", "tool0", STRAIGHT, [capsule("nozzle", 0.02, 0.08, 0.065)]),
        ([0.55, 0.0, 0.2], DOWN),
        (0.1, 0.2, 0.1),
        {"ds": 0.03, "dphi": 0.4, "droll": 0.8, "knot": 0.06},
        [0.0, 0.4, 0.0, -1.4, 0.0, 1.3, 0.0],
        roll=("free", [-0.6, 0.6]),
        kind="S-R-S and a roll",
    ),
    "sda5f": Arm(
        robot(
            "sda5f",
            "arm_left_link_tool0",
            {"xyz": [0, 0, 0.1]},
            [capsule("polisher", 0.025, 0.04, 0.048)],
            hold={"torso_joint_b1": 0.0},
        ),
        ([0.62, 0.25, 0.95], poses.of_rpy(0, math.pi / 2, -0.3)),
        (0.05, 0.15, 0.1),
        ANGLE,
        [-0.6241, -1.2398, 0.7037, -0.7659, 0.8316, 1.6, -0.3086],
        kind="S-R-S",
    ),
    "kr6": Arm(
        robot("kr6_like", "flange", BENT, TORCH),
        ([0.55, 0.0, 0.2], poses.of_rpy(math.pi, 0.3, 0)),
        (0.08, 0.15, 0.08),
        ARCS,
        [0, -1.4, 1.5, 0, 0.6, 0],
        roll=("free", "free", [-1.0, 1.0]),
        kind="roll",
    ),
    "ur5e": Arm(
        robot(
            "ur5e_like",
            "flange",
            {"xyz": [0.05, 0, 0.16], "rpy": [0, math.pi / 6, 0]},
            [capsule("spindle", 0.03, 0.06, 0.065)],
        ),
        ([0.45, 0.0, 0.15], DOWN),
        (0.08, 0.15, 0.06),
        ARCS,
        [0, -1.4, 1.6, -1.8, -1.57, 0],
        roll=([-0.5, 0.5], [-1.2, 0.8], "free"),
        kind="roll",
    ),
    "panda": Arm(
        robot("panda_like", "flange", STRAIGHT, [capsule("spindle", 0.025, 0.06, 0.06)]),
        ([0.5, 0.0, 0.2], DOWN),
        (0.08, 0.15, 0.08),
        ARCS,
        [0, -0.5, 0, -2.2, 0, 1.7, 0.8],
    ),
    "xarm7": Arm(
        robot(
            "xarm7_like", "flange", {"xyz": [0, 0, 0.13]}, [capsule("spindle", 0.03, 0.05, 0.06)]
        ),
        ([0.45, 0.0, 0.2], DOWN),
        (0.06, 0.15, 0.06),
        ARCS,
        [0, -0.4, 0, 0.9, 0, 1.3, 0],
    ),
    "fetch": Arm(
        robot("fetch_like", "flange", {"xyz": [0, 0, 0.05]}, [capsule("pad", 0.03, 0.02, 0.03)]),
        ([0.6, 0.0, 0.7], DOWN),
        (0.06, 0.15, 0.06),
        ARCS,
        [0.0, -0.2, 0.0, 1.5, 0.0, 0.6, 0.0],
    ),
    "rail": Arm(
        robot("ur10e_rail_like", "flange", BENT, TORCH, base="track"),
        (
            [0.0, 0.7, 0.2],
            [0.2705980500730985, -0.6532814824381883, -0.6532814824381883, -0.2705980500730985],
        ),
        (0.5, 0.06, 0.08),
        ARCS,
        [0.0, 1.57, -1.4, 1.6, -1.8, -1.57, 0.0],
    ),
    "turntable": Arm(
        robot("kr6_turntable_like", "flange", BENT, TORCH, base="plate"),
        ([0.03, 0.0, 0.1], poses.of_rpy(math.pi, 0.3, 0)),
        (0.06, 0.06, 0.05),
        ARCS,
        [0.0, 0.0, -1.4, 1.5, 0.0, 0.6, 0.0],
        part_below=0.08,
    ),
}

# Two arms: the robot, and of each arm its part of a workcell and about where its tool works.
CELLS = {
    "pair": (
        {
            "urdf": f"{DATA}/robots/iiwa14_pair.urdf",
            "srdf": f"{DATA}/robots/iiwa14_pair.srdf",
            "base_link": "floor",
        },
        [
            (
                {
                    "name": side,
                    "tip_link": f"{side}_tool0",
                    "tool": {"xyz": [0, 0, 0.12]},
                    "attached": [capsule(f"torch_{side}", 0.012, 0.07, 0.055)],
                },
                ([x, 0.0, 0.36], poses.of_rpy(0, pitch, 0)),
            )
            for side, x, pitch in (("left", 0.61, 3 * QUARTER), ("right", 0.69, -3 * QUARTER))
        ],
    ),
    "sda10f": (
        {
            "urdf": f"{DATA}/robots/sda10f.urdf",
            "srdf": f"{DATA}/robots/sda10f.srdf",
            "base_link": "base_link",
            "hold": {"torso_joint_b1": 0.0},
        },
        [
            (
                {
                    "name": side,
                    "tip_link": f"arm_{side}_link_tool0",
                    "tool": {"xyz": [0, 0, 0.1]},
                    "attached": [capsule(f"hand_{side}", 0.02, 0.04, 0.05)],
                },
                ([0.68, y, 1.0], poses.of_rpy(0, math.pi / 2, yaw)),
            )
            for side, y, yaw in (("left", 0.22, -0.5), ("right", -0.22, 0.5))
        ],
    ),
}
