#pragma once

#include <string>

/// Private to protocols/format: values as they stand in a canonical file.
namespace palpate::protocols {

/// The shortest number y, in the file's unit, that a reader turns into `si` by y / per_si. A few
/// doubles are no such quotient; then y of the nearest one that is. Written, read and written again
/// it is the same text.
[[nodiscard]] std::string toml_text(double si, double per_si);

/// In quotes, with escapes.
[[nodiscard]] std::string toml_text(const std::string& text);

}  // namespace palpate::protocols
