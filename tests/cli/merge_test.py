#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""swivel merge from outside: shards of campaigns and placements against runs that were not split,
and what it refuses."""
import json
import os
import random
import re
import shutil
import subprocess
import unittest

from cli_test import DATA, PROBLEMS, SWIVEL, WithFolder, run
from pages import data_of
from trials import seed

PROBLEM = PROBLEMS / "experiment_c.yaml"
QUICK = ("--ds", "0.02", "--dphi", "0.2", "--edges", "nodes")
MARK = "# swivel "


def unpacked(file):
    """The text of a file, of a page with its data as JSON in place of what it holds packed."""
    text = file.read_text()
    if file.suffix != ".html":
        return text
    data = json.dumps(data_of(file), separators=(",", ":"), ensure_ascii=False)
    return re.sub(
        r'(<script id="data"[^>]*>).*?(?=</script>)', lambda m: m.group(1) + data, text,
        flags=re.DOTALL,
    )


def without_scene(text):
    """A page of placements without its view in three dimensions, which is not a shard's to know."""
    return re.sub(r'"scene":.*?</script>', "", text, count=1, flags=re.DOTALL)


def without_times(text):
    """Of a campaign's CSV, summary or page."""
    text = re.sub(r"^((?:[^,\n]*,){3})[0-9.]+,", r"\1-,", text, flags=re.MULTILINE)
    return re.sub(
        r'"plan_ms": ?(\{[^}]*\}|[0-9.e+-]+)|plan [0-9.]+ ms .*above [0-9.]+\)', "plan_ms", text
    )


class Merge(WithFolder):
    def ran(self, *arguments, code=0, **environment):
        done = subprocess.run(
            [SWIVEL, *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=300,
            env={
                **{key: value for key, value in os.environ.items() if not key.startswith("SLURM_")},
                **environment,
            },
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def pages(self):
        done = run(
            "campaign", PROBLEM, "--episodes", "1", *QUICK, "--report", self.folder / "page.html"
        )
        return done.returncode == 0

    def shards(self, count, *command, name="shard"):
        files = [self.folder / f"{name}{k}.csv" for k in range(count)]
        for k, file in enumerate(files):
            self.ran(*command, "--shard", f"{k}/{count}", "--out", file)
            self.assertTrue(file.read_text().startswith(MARK + command[0] + " {"))
        return files

    def test_campaigns(self):
        page = ("--report",) if self.pages() else ()
        draw = random.Random(seed(20260702))
        joined = 0
        for episodes, count in ((13, draw.randint(2, 6)), (2, 3), (5, 1)):
            command = (
                "campaign", PROBLEM, "--episodes", episodes, "--seed", draw.randint(0, 2**63),
                *QUICK
            )
            out, html, summary = (self.folder / f"whole.{end}" for end in ("csv", "html", "json"))
            told = self.ran(
                *command,
                "--out",
                out,
                "--json",
                summary,
                *[word for option in page for word in (option, html)],
            )
            whole = [unpacked(file) for file in (out, summary, html) if file.exists()]
            files = self.shards(count, *command)
            draw.shuffle(files)
            again = self.ran(
                "merge",
                out,
                *files,
                "--json",
                summary,
                *[word for option in page for word in (option, html)],
            )
            for before, after in zip(
                whole, [unpacked(file) for file in (out, summary, html) if file.exists()]
            ):
                self.assertEqual(without_times(after), without_times(before))
                joined += 1
            self.assertEqual(without_times(again.stdout), without_times(told.stdout))
        self.assertEqual(joined, 3 * (3 if page else 2))

    def test_placements(self):
        page = ("--report",) if self.pages() else ()
        draw = random.Random(seed(20260703))
        grid = ("--x", "-0.1:0.1:0.05", "--y", "0:0.1:0.05", "--yaw", "0.1")
        for thing in (
            ("--object", "door", *grid, "--best", "clearance,cost"),
            ("--object", "post", *grid, "--z", "0:0.01:0.01"),
            ("--base", *grid),
            ("--path", "--x", "-0.1:0.1", "--sample", "7", "--seed", "4"),
            ("--object", "door", "--x", "0:0.1:0.1"),
        ):
            command = ("place", PROBLEM, *QUICK, *thing)
            outputs = (
                {"out": "csv"}
                | ({"svg": "svg"} if "--y" in thing else {})
                | ({"report": "html"} if page else {})
            )
            files = {name: self.folder / f"whole.{end}" for name, end in outputs.items()}
            told = self.ran(
                *command, *[word for name, file in files.items() for word in ("--" + name, file)]
            )
            whole = {name: unpacked(file) for name, file in files.items()}
            shards = self.shards(draw.randint(2, 4), *command)
            draw.shuffle(shards)
            out = files.pop("out")
            again = self.ran(
                "merge",
                out,
                *shards,
                *[word for name, file in files.items() for word in ("--" + name, file)],
            )
            files["out"] = out
            # Not assertEqual, which would draw the difference of two pages.
            for name, file in files.items():
                self.assertTrue(
                    without_scene(unpacked(file)) == without_scene(whole[name]), name
                )
                self.assertEqual(
                    name == "report" and unpacked(file) != whole[name],
                    name == "report" and '"scene":{' in whole[name],
                )
            self.assertEqual(again.stdout, re.sub("; [0-9.]+ s, [0-9.]+ a second", "", told.stdout))

    def test_nothing_has_a_path(self):
        command = ("place", PROBLEM, *QUICK, "--object", "door", "--x", "5:6:0.5")
        files = self.shards(2, *command)  # each of which is answered
        self.ran("merge", self.folder / "all.csv", *files, code=1)

    def test_the_share_of_a_task_of_a_job_array(self):
        command = ("place", PROBLEM, *QUICK, "--object", "door", "--x", "-0.1:0.1:0.02")
        self.ran(*command, "--out", self.folder / "whole.csv")
        files = []
        for task in ("4", "6", "8"):
            files.append(self.folder / f"task{task}.csv")
            self.ran(
                *command, "--shard", "auto", "--out", files[-1], SLURM_ARRAY_TASK_ID=task,
                SLURM_ARRAY_TASK_COUNT="3", SLURM_ARRAY_TASK_MIN="4", SLURM_ARRAY_TASK_STEP="2"
            )
        self.ran("merge", self.folder / "all.csv", *files)
        self.assertEqual(
            (self.folder / "all.csv").read_bytes(), (self.folder / "whole.csv").read_bytes()
        )
        done = self.ran(*command, "--shard", "auto", "--out", files[0], code=2)
        self.assertIn("SLURM_ARRAY_TASK_ID is not set", done.stderr)

    def refused(self, words, *arguments):
        """One line with these words; nothing is written."""
        out = self.folder / "out.csv"
        out.write_text("what was there")
        before = {file: file.read_bytes() for file in self.folder.iterdir() if file.is_file()}
        done = self.ran("merge", out, *arguments, code=2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in (*words, "allowed"):
            self.assertIn(word, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(
            {file: file.read_bytes() for file in self.folder.iterdir() if file.is_file()}, before
        )

    def test_what_is_not_one_run_is_refused(self):
        for folder in ("robots", "meshes", "paths", "problems"):
            shutil.copytree(DATA / folder, self.folder / "data" / folder)
        problem = self.folder / "data/problems/experiment_c.yaml"
        campaign = ("campaign", problem, "--episodes", "6", *QUICK)
        place = ("place", problem, *QUICK, "--object", "door", "--x", "0:0.1:0.02")
        a, b, c = self.shards(3, *campaign, name="c")
        p, q = self.shards(2, *place, name="p")
        self.refused(("shard 1/3", "missing"), a, c)
        self.refused(("shard 2/3", "missing: 2 of 3"), a, b)
        self.refused(("shard 0/2", "missing"), q)
        self.refused(("shard 1/3 again", "c1.csv"), a, b, b, c)
        self.refused(("of swivel place", "of swivel campaign"), a, b, p)
        self.refused(("--json", "placements"), p, q, "--json", self.folder / "s.json")
        self.refused(("--svg", "campaign"), a, b, c, "--svg", self.folder / "s.svg")
        self.refused(("--svg", "fewer than two"), p, q, "--svg", self.folder / "s.svg")
        whole = self.folder / "whole.csv"
        self.ran(*campaign, "--out", whole)
        self.refused(("whole.csv:1", "does not say which shard"), whole)
        self.refused((str(self.folder / "nowhere.csv"),), self.folder / "nowhere.csv")
        done = self.ran("merge", a, a, b, c, code=2)
        self.assertIn("OUT", done.stderr)
        other = self.folder / "other.csv"
        count = 0
        for command, first, changes in (
            (
                campaign,
                a,
                (
                    ("--seed", "2", "seed 2"),
                    ("--ds", "0.021", "ds 0.021"),
                    ("--dphi", "0.21", "dphi 0.21"),
                    ("--edges", "continuous", "edges continuous"),
                    ("--planner", "lazy", "planner lazy"),
                    ("--episodes", "7", "of 7 episodes"),
                ),
            ),
            (
                place,
                p,
                (
                    ("--x", "0:0.2:0.02", "x 0:0.2:0.02"),
                    ("--y", "0.1", "with y 0.1"),
                    ("--best", "speed", "best speed"),
                    ("--object", "post", "object post"),
                    ("--sample", "6", "x 0:0.1, where"),
                ),
            ),
        ):
            for option, value, word in changes:
                words = list(map(str, command))
                if option in words:
                    words[words.index(option) + 1] = value
                else:
                    words += [option, value]
                if option == "--sample":  # of ranges without a step
                    words = [re.sub(r"^(.*:.*):.*$", r"\1", word) for word in words]
                self.ran(*words, "--shard", f"1/{3 if first is a else 2}", "--out", other)
                self.refused((word, "other.csv", first.name), first, other)
                count += 1
        self.ran(*campaign, "--shard", "1/2", "--out", other)
        self.refused(("one of 2 shards", "one of 3"), a, other)
        for name in ("problems/experiment_c.yaml", "robots/sda5f.srdf"):
            file = self.folder / "data" / name
            before = file.read_bytes()
            file.write_bytes(before + b"\n")
            for command, first, share in ((campaign, a, "1/3"), (place, p, "1/2")):
                self.ran(*command, "--shard", share, "--out", other)
                self.refused(
                    (
                        "was another",
                        "the problem file" if name.endswith("yaml") else name,
                        first.name,
                    ),
                    first,
                    other,
                )
                count += 1
            file.write_bytes(before)
        self.assertEqual(count, 15)

    def test_what_is_no_finished_shard_is_refused(self):
        place = ("place", PROBLEM, *QUICK, "--object", "door", "--x", "0:0.1:0.02")
        p, q = self.shards(2, *place)
        campaign = self.shards(1, "campaign", PROBLEM, "--episodes", "4", *QUICK, name="c")[0]
        bad = self.folder / "bad.csv"
        count = 0
        for good in (p, campaign):
            lines = good.read_text().splitlines(keepends=True)
            for words, text in (
                (("of the", "rows"), lines[:-1]),
                (("bad.csv:4",), lines[:3] + lines[4:]),
                (("bad.csv:4",), [*lines[:3], lines[2], *lines[3:]]),
                (("more rows",), [*lines, lines[-1]]),
                (("ends within a row",), [*lines[:-1], lines[-1][:-4]]),
                (("another header",), [lines[0], *lines[2:]]),
                (("does not say",), lines[1:]),
                (("does not say",), [lines[0].replace("total", "totals"), *lines[1:]]),
                (("does not say",), [lines[0].replace("settings", "setting"), *lines[1:]]),
                (("does not say",), [lines[0][:40] + "\n", *lines[1:]]),
                (
                    ("not a row",),
                    [
                        *lines[:3],
                        lines[3].replace("solved", "sold").replace("infeasible", "sold"), *lines[4:]
                    ],
                ),
                (("does not say",), []),
            ):
                bad.write_text("".join(text))
                self.refused(("bad.csv", *words), *((bad, q) if good is p else (bad,)))
                count += 1
        self.assertEqual(count, 24)
        # A shard that ran out of time.
        done = run(
            "place", PROBLEM, "--object", "door", "--x", "-0.1:0.1:0.0005", "--y", "0:0.1:0.001",
            "--timeout", "1", "--threads", "1", "--shard", "0/2", "--out", bad
        )
        self.assertEqual(done.returncode, 3, done.stderr)
        self.refused(("rows of shard 0/2", "finished"), bad)

    def test_shards_are_refused_where_they_mean_nothing(self):
        door = ("--object", "door", "--x", "0:0.1:0.05")
        for options, words in (
            (("--refine-grid",), ("--refine-grid", "--shard")),
            (("--write", self.folder / "w.yaml"), ("--write", "--shard")),
        ):
            done = self.ran("place", PROBLEM, *QUICK, *door, "--shard", "0/2", *options, code=2)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            for word in (*words, "allowed"):
                self.assertIn(word, done.stderr)
        for shard in ("3/3", "1", "a/b", "0/0", "-1/2"):
            self.ran("place", PROBLEM, *QUICK, *door, "--shard=" + shard, code=2)


if __name__ == "__main__":
    unittest.main()
