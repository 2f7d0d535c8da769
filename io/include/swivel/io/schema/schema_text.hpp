// SPDX-License-Identifier: BSD-3-Clause
// What files may say, for editors, validators and the documentation: made of the schema that the reader of problem files asks.
#pragma once
#include <string>

namespace swivel::io {

/// JSON Schema, draft 7, of a problem file. What takes several values or other files to judge is the reader's alone.
[[nodiscard]] std::string problem_json_schema();
/// The same of RESULT.json.
[[nodiscard]] std::string result_json_schema();
/// The same of the summary of a campaign.
[[nodiscard]] std::string campaign_json_schema();

/// The tables of docs/formats.md in Markdown, each between "<!-- schema NAME -->" and "<!-- /schema -->".
[[nodiscard]] std::string schema_tables();

}  // namespace swivel::io
