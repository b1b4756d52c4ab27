#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate::protocols {

/// What differs between two canonical texts (to_toml()), key by key: "friction.rough mu_d 0.4
/// there, 0.1 here". Tables of a list are known by their name, or by their number. In the order of
/// `there`, then what only `here` has.
[[nodiscard]] std::vector<std::string> differences(std::string_view there, std::string_view here);
/// The first six in one line, and how many more there are.
[[nodiscard]] std::string differences_text(std::string_view there, std::string_view here);

}  // namespace palpate::protocols
