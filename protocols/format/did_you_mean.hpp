#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpate::protocols {

/// ": did you mean ...?" for the nearest of `known`, upper or lower case alike, or `otherwise` if none is near: a
/// key may be deleted, of a value what may stand there is said.
[[nodiscard]] std::string suggestion(std::string_view unknown,
                                     std::span<const std::string_view> known,
                                     std::string_view otherwise = ": delete it");

/// The same for words that are made while the program runs.
[[nodiscard]] std::string suggestion(std::string_view unknown,
                                     std::span<const std::string> known,
                                     std::string_view otherwise);

}  // namespace palpate::protocols
