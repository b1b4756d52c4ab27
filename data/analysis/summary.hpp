#pragma once

#include <string>

#include "data/store/database.hpp"

namespace palpate::data {

/// What a person wants to see first, for a terminal: by study and run kind the confusion matrix;
/// the share correct person by person, its mean over people, and friction as a difference within a
/// person (people_text.hpp); what a rule estimates; and what the file is called. Simulated and
/// pilot data are never added to real ones, and say so in their title. Where the protocol has rules
/// of exclusion what is said over people comes twice: of everybody who consents, and without those
/// whom the rules leave out. left_out.hpp says who that is.
[[nodiscard]] std::string summary_text(Database& database);
/// The same for programs: a member of `studies` for each study and run kind.
[[nodiscard]] std::string summary_json(Database& database);

/// Two queries to try, as they may be pasted into a shell; `file` is quoted.
[[nodiscard]] std::string example_queries(const std::string& file);

}  // namespace palpate::data
