#pragma once

#include <string>
#include <vector>

#include "data/store/database.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// What the file says against running spec.key.participant now: a code much like another one,
/// another version of the protocol, no consent, the other handedness. Asked before the rig's
/// questions, which wait without limit, and again in the transaction that begins or resumes the
/// session. What does not stand against it is said, unless spec.said has it.
/// @param database  none: the file is not there yet, and knows nobody
/// @return all that had to be said
/// @throws std::invalid_argument with what stands against it, and the remedy
std::vector<std::string> admit(data::Database* database,
                               const std::string& file,
                               const RigSpec& spec);

}  // namespace palpate::ui
