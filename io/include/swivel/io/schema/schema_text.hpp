// SPDX-License-Identifier: BSD-3-Clause
// Schemas of files, for editors, validators and the documentation, made from the schema that the
// reader of problem files uses.
#pragma once
#include <string>

namespace swivel::io {

/// Returns the JSON Schema, draft 7, of a problem file. Conditions on several values or on other
/// files are not in it; only the reader tests them.
[[nodiscard]] std::string problem_json_schema();
/// Returns the JSON Schema, draft 7, of RESULT.json.
[[nodiscard]] std::string result_json_schema();
/// Returns the JSON Schema, draft 7, of the summary of a campaign.
[[nodiscard]] std::string campaign_json_schema();

/// Returns the tables of docs/formats.md in Markdown, each between "<!-- schema NAME -->" and "<!--
/// /schema -->".
[[nodiscard]] std::string schema_tables();

}  // namespace swivel::io
