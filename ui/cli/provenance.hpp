#pragma once

#include <string>
#include <utility>
#include <vector>

namespace palpate::ui {

/// What shaped a session besides its protocol: program, compiler, C library, kernel, processor kind.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance();

}  // namespace palpate::ui
