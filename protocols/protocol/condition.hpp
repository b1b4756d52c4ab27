#pragma once

#include <compare>
#include <cstddef>

namespace palpate::protocols {

/// A cell of the factorial design, by index into Protocol::objects and Protocol::frictions.
struct Condition {
    std::size_t object = 0;
    std::size_t friction = 0;

    friend auto operator<=>(const Condition&, const Condition&) = default;
};

}  // namespace palpate::protocols
