// SPDX-License-Identifier: BSD-3-Clause
#include "problems/problem_reader.hpp"
#include "schema/schema.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

Problem load_problem(const std::filesystem::path& yaml) {
  YamlSection root = load_yaml(yaml, problem_schema()).section();
  if (root.find_filled("arms")) return read_workcell(yaml, std::move(root));
  if (root.find_filled("strokes") || lift_offs_of(root)) return read_job(yaml, std::move(root));
  return one_path(ProblemReader(yaml, std::move(root)).read());
}

PathProblem load_path_problem(const std::filesystem::path& yaml) {
  return ProblemReader(yaml, load_yaml(yaml, problem_schema()).section()).read();
}

}  // namespace swivel::io
