// What a command tells its reader: one set of facts, as JSON or as text.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "wavefog/fogmap/fog_file.h"

namespace wavefog::cli {

using Facts = nlohmann::ordered_json;

/// Prints `facts` (an object) on stdout: indented JSON, or one `key: value` line each, with arrays
/// of objects as tables and sentences one a line.
void print_facts(const Facts& facts, bool as_json);

/// "wavefog: warning: ..." on stderr.
void warn(const std::string& message);

/// Basis, family, levels, rectangle, extinction and profile of a fog, in the words of the flags.
Facts fog_facts(const Fog& fog);

/// Of a .wfog: how many of its levels are there and, of a whole one, the error that it states, in
/// densities. Of other files nothing.
Facts stream_facts(const LoadNotes& notes);

}  // namespace wavefog::cli
