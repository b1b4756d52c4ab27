#pragma once

#include "tests/support/std.hpp"

// Catch2 v3 (Debian 13, Ubuntu 24.04) and v2 (Debian 12) behind one include.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // v2 has it in the global namespace
using Catch::Matchers::MatcherBase;
#else
#include <catch2/catch.hpp>
using Catch::MatcherBase;
#endif

namespace palpate::tests {

using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

/// How many of `all` seeded cases are tried: a quarter under sanitizers, which look at memory,
/// where the next seed does what the last one did.
template <class Count>
[[nodiscard]] constexpr Count cases(Count all) {
#ifdef PALPATE_SANITIZED
    return (all + 3) / 4;
#else
    return all;
#endif
}

/// Seeds of fault schedules: 0 to `usual`, or as PALPATE_FAULT_SCHEDULES asks: "100000", or
/// "50000-100000" for those from 50,000 on.
[[nodiscard]] inline auto schedules(std::uint64_t usual) {
    std::uint64_t first = 0;
    std::uint64_t past = usual;
    if (const char* asked = std::getenv("PALPATE_FAULT_SCHEDULES")) {
        char* rest = nullptr;
        past = std::strtoull(asked, &rest, 10);
        if (*rest == '-') {
            first = std::exchange(past, std::strtoull(rest + 1, nullptr, 10));
        }
    }
    return std::views::iota(first, past);
}

/// Of a text that has all of these in it; a failure names the first that it lacks.
class Has : public MatcherBase<std::string> {
public:
    template <class... Texts>
    explicit Has(const Texts&... texts) : texts_{std::string(texts)...} {}

    [[nodiscard]] bool match(const std::string& text) const override {
        return none_is(false, text);
    }
    [[nodiscard]] std::string describe() const override {
        return "has all of " + Catch::Detail::stringify(texts_) + but_;
    }

protected:
    /// None of them is in the text, or none is missing; the first that is otherwise is remembered.
    [[nodiscard]] bool none_is(bool there, const std::string& text) const {
        const auto other = std::find_if(texts_.begin(), texts_.end(), [&](const auto& part) {
            return (text.find(part) != std::string::npos) == there;
        });
        but_ = other == texts_.end() ? "" : ", but not of " + Catch::Detail::stringify(*other);
        return other == texts_.end();
    }
    std::vector<std::string> texts_;
    mutable std::string but_;
};

/// Of a text that has none of these in it; a failure names the first that it has.
class HasNone : public Has {
public:
    using Has::Has;

    [[nodiscard]] bool match(const std::string& text) const override { return none_is(true, text); }
    [[nodiscard]] std::string describe() const override {
        return "has none of " + Catch::Detail::stringify(texts_) + but_;
    }
};

/// What the error says that ends `act`, or "accepted".
template <class Error, class Act>
std::string refusal_of(const Act& act) {
    try {
        static_cast<void>(act());
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

/// For GENERATE: `all` seeds from 0, fewer under sanitizers.
template <class Count>
auto seeds(Count all) {
    return Catch::Generators::range(Count{0}, cases(all));
}

}  // namespace palpate::tests

// As Approx: what nearly every test says.
using namespace palpate;
using namespace palpate::tests;

/// In a test case that runs once for each of the values: `name` is it, and a failure says which.
#define EACH(name, ...)                      \
    const auto name = GENERATE(__VA_ARGS__); \
    CAPTURE(name)

/// The same for each of `count` seeds.
#define SEED(count) EACH(seed, palpate::tests::seeds(count))

/// With a Random of the seed, or of it and what is added to it (tests/support/random.hpp).
#define SEEDED(random, count, ...) \
    SEED(count);                   \
    palpate::tests::Random random(seed __VA_OPT__(+) __VA_ARGS__)
