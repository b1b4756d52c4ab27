#pragma once

#include <string>
#include <utility>
#include <vector>

#include "protocols/protocol/protocol.hpp"

namespace palpate::ui {

/// What shaped a session besides its protocol: the program and its build id, compiler, the
/// libraries as they run (toml++, CLI11 and fmt as compiled; SDL2 where there is a screen),
/// operating system, kernel, processor. Nothing that names the machine or its owner. And the hash
/// of every object's geometry: protocols::object_hashes().
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance(
    const protocols::Protocol& protocol);

/// The linker's build id of the program that runs, in hexadecimal: a hash of its code and data. Two
/// programs with the same one are the same. "unknown" if it was linked without.
[[nodiscard]] std::string build_id();

}  // namespace palpate::ui
