#pragma once

#include "tests/support/cases.hpp"

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

/// Of a text that has all of these in it; a failure names the first that it lacks.
class Has : public MatcherBase<std::string> {
public:
    template <class... Texts>
    explicit Has(const Texts&... texts) : texts_{std::string(texts)...} {}

    [[nodiscard]] bool match(const std::string& text) const override {
        const auto lacking = std::find_if(texts_.begin(), texts_.end(), [&](const auto& part) {
            return text.find(part) == std::string::npos;
        });
        lacking_ =
            lacking == texts_.end() ? "" : ", and lacks " + Catch::Detail::stringify(*lacking);
        return lacking == texts_.end();
    }
    [[nodiscard]] std::string describe() const override {
        return "has all of " + Catch::Detail::stringify(texts_) + lacking_;
    }

private:
    std::vector<std::string> texts_;
    mutable std::string lacking_;
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
