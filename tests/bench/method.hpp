#pragma once

#include <concepts>

#include "engine/geometry/vec.hpp"
#include "tests/support/std.hpp"

namespace palpate::bench {

using engine::Vec;
using engine::Vec2;
using engine::Vec3;

/// What every method says each tick.
template <int D>
struct Answer {
    Vec<D> foot{};
    double distance = 0.0;  ///< from HIP to the foot, m, >= 0
};

/// Colour in the picture, and whether there is an error to measure.
enum class Kind : std::uint8_t {
    floor,    ///< cost of a part of any method: answers nothing
    global,   ///< ours, the nearest point of all
    tracker,  ///< ours or the thesis', follows one foot
    mesh,     ///< on a polyline or triangles
    peer,     ///< a library's, on the exact curve
};

/// A way to find the closest point, tick by tick.
template <int D>
class Method {
public:
    Method(std::string name, Kind kind) : name_(std::move(name)), kind_(kind) {}
    Method(const Method&) = delete;
    Method& operator=(const Method&) = delete;
    virtual ~Method() = default;

    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] Kind kind() const noexcept { return kind_; }

    /// Before a path: state is that of a HIP that has rested at `first`.
    virtual void reset(const Vec<D>& first) = 0;
    virtual Answer<D> answer(const Vec<D>& hip) = 0;
    /// One answer a tick into the sink, in one loop: no virtual call inside is timed.
    virtual void run(std::span<const Vec<D>> hips) = 0;

private:
    std::string name_;
    Kind kind_;
};

template <int D>
using Methods = std::vector<std::unique_ptr<Method<D>>>;

/// The compiler must believe that somebody reads `value`.
template <class Value>
[[gnu::always_inline]] inline void keep(const Value& value) {
    asm volatile("" : : "m"(value));
}

/// What a method is made of: two functions, no base class. Every tracker of the thesis and the
/// certified one are plugged in like this:
///
///     struct Tracker {
///         void reset(const Vec2& first) { foot.place_at(first); }
///         Answer<2> answer(const Vec2& hip) { return {foot.step(hip), foot.distance()}; }
///         ...
///     };
///     methods.push_back(make_method<2>("feedback, kappa 1", Kind::tracker, Tracker{...}));
template <class Part, int D>
concept Answers = requires(Part part, const Vec<D>& hip) {
    part.reset(hip);
    { part.answer(hip) } -> std::same_as<Answer<D>>;
};

template <int D, class Part>
requires Answers<Part, D>
[[nodiscard]] std::unique_ptr<Method<D>> make_method(std::string name, Kind kind, Part part) {
    class Whole final : public Method<D> {
    public:
        Whole(std::string text, Kind sort, Part inner)
            : Method<D>(std::move(text), sort), part_(std::move(inner)) {}
        void reset(const Vec<D>& first) override { part_.reset(first); }
        Answer<D> answer(const Vec<D>& hip) override { return part_.answer(hip); }
        void run(std::span<const Vec<D>> hips) override {
            for (const Vec<D>& hip : hips) {
                keep(part_.answer(hip));
            }
        }

    private:
        Part part_;
    };
    return std::make_unique<Whole>(std::move(name), kind, std::move(part));
}

}  // namespace palpate::bench
