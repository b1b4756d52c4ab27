#pragma once

#include <string>

namespace palpate::protocols {

/// Of toml++, which this program was compiled with.
[[nodiscard]] std::string toml_version();

}  // namespace palpate::protocols
