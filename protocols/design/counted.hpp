#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace palpate::protocols {

/// "1 trial", "2 trials", "0 trials": how many of something, for sentences.
/// @param many  where "s" alone does not make more of it: "1 of them is", "2 of them are"
[[nodiscard]] std::string counted(std::integral auto n,
                                  std::string_view one,
                                  std::string_view many = {}) {
    std::string text = std::to_string(n) + ' ';
    text += n == 1 || many.empty() ? one : many;
    return n == 1 || !many.empty() ? text : text + 's';
}

}  // namespace palpate::protocols
