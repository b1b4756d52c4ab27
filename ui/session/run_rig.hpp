#pragma once

#include <optional>
#include <string>

#include "protocols/session/session.hpp"
#include "data/store/database.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/session/rig.hpp"

namespace palpate::ui {

/// How a session went, for the command to report.
struct RigEnd {
    protocols::SessionEnd session{};
    std::string
        head{};  ///< of the session's chain of hashes (data/store/chain.hpp); empty: none yet
    bool broken = false;  ///< some link of it did not hold before this run
};

/// Opens what the session is felt on, and says what should be known of it. Before windows, as
/// open_apparatus().
/// @throws as that; std::invalid_argument for what nobody should hold
[[nodiscard]] OpenedApparatus open_and_check(const RigSpec& spec);

/// Plans, opens or resumes the session in `database`, and runs it to its end. Prints a line when it
/// starts and one for every trial, to standard output.
/// @param opened_before  by open_and_check() of the same `spec`; none: it is opened now
/// @throws what the parts throw; the force is off and everything recorded is kept
[[nodiscard]] RigEnd run_rig(data::Database& database,
                             const RigSpec& spec,
                             std::optional<OpenedApparatus> opened_before = {});

/// Whether it finished; else somebody ended it.
/// @throws std::runtime_error where it was given up, or its display is gone: why, and how it goes
/// on
[[nodiscard]] bool finished(const protocols::SessionEnd& end);

}  // namespace palpate::ui
