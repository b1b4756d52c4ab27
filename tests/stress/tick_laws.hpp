#pragma once

#include "engine/rendering/scene.hpp"
#include "tests/stress/exact_forms.hpp"

/// What must hold on every tick of every contact, whatever is felt and whoever feels it.
namespace palpate::stress {

/// A law that did not hold.
struct Breach {
    std::string law;
    std::size_t tick = 0;
    double value = 0.0;  ///< what was found
    double limit = 0.0;  ///< what the law allows
};

/// Of the largest length in the scene.
inline constexpr double kSameLength = 1e-12;

/// A slide ends on its root to some 1e-11 of the size where the cone opens slowly, near a centre of
/// curvature: so many times kSameLength.
inline constexpr double kConeSlack = 100.0;

/// HIPs further away than this, m, are only asked for finite forces: squares lose the object.
inline constexpr double kFar = 1e9;

template <class Point>
[[nodiscard]] double largest(const Point& v) noexcept {
    double most = 0.0;
    for (int k = 0; k < Point::length(); ++k) {
        most = std::max(most, std::fabs(v[k]));
    }
    return most;
}

template <class Point>
[[nodiscard]] bool finite(const Point& v) noexcept {
    bool all = true;
    for (int k = 0; k < Point::length(); ++k) {
        all = all && std::isfinite(v[k]);
    }
    return all;
}

template <class AnyContact>
[[nodiscard]] bool free(const AnyContact& contact) noexcept {
    return contact.mode == engine::Mode::free;
}

/// What the laws of every kind of contact add up, and the first that did not hold.
class Ledger {
protected:
    void check(const char* law, double value, double limit) {
        if (!breach_ && !(value <= limit)) {
            breach_ = Breach{.law = law, .tick = ticks_, .value = value, .limit = limit};
        }
    }
    void check(const char* law, bool holds) { check(law, holds ? 0.0 : 1.0, 0.0); }

    /// Of the numbers of a contact in the plane or in space.
    template <class AnyContact>
    void check_numbers(const AnyContact& contact) {
        check("finite in, finite out", finite(contact.force) && finite(contact.go) &&
                                           std::isfinite(contact.normal_force) &&
                                           std::isfinite(contact.tangential_force));
        check("no force while free",
              !free(contact) || (contact.force == decltype(contact.force){} &&
                                 contact.normal_force == 0.0 && contact.tangential_force == 0.0));
        check("the surface only pushes", -contact.normal_force, 0.0);
    }

    /// F_k . (h_k+1 - h_k) <= E_k - E_k+1 + K/2 |h_k+1 - h_k|^2, summed over an episode.
    /// @param springy  the force is K (GO - HIP)   @param rounding  J
    template <class Tick>
    void check_energy(
        const Tick& last, const Tick& now, bool springy, double stiffness, double rounding) {
        const auto stretch = now.contact.go - now.h;
        const auto dh = now.h - last.h;
        const double energy = 0.5 * stiffness * glm::dot(stretch, stretch);
        const double kept = free(now.contact) ? 0.0 : energy;
        if (ledger_ && started_ && (springy || free(now.contact))) {
            const double done = glm::dot(last.contact.force, dh);
            const double leak = 0.5 * stiffness * glm::dot(dh, dh);
            work_ += done;
            leak_ += leak;
            scale_ += std::fabs(done) + leak + kept;
            check("a contact gives no more work than K/2 sum |dh|^2", work_,
                  start_ - kept + leak_ + 1e-12 * scale_ + rounding);
        }
        if (free(now.contact) || !springy) {
            ledger_ = false;
        } else if (!ledger_) {
            ledger_ = true;
            work_ = leak_ = 0.0;
            start_ = scale_ = energy;
        }
    }

    std::size_t ticks_ = 0;
    bool started_ = false;
    bool ledger_ = false;  ///< an episode of springy ticks is being added up
    std::optional<Breach> breach_;

private:
    double start_ = 0.0;  ///< energy it began with, J
    double work_ = 0.0;   ///< on the user, J
    double leak_ = 0.0;   ///< K/2 sum |dh|^2, J
    double scale_ = 0.0;  ///< sum of magnitudes, for rounding, J
};

/// Watches one hand in one scene. Lengths count as equal within kSameLength of the largest length
/// in play (size of the outline, HIP's distance from the world's origin), forces within K times
/// that.
class TickLaws : private Ledger {
public:
    explicit TickLaws(const engine::Scene& scene);

    /// The first law that the tick broke. @param before, after the states that the tick began and
    /// ended with
    [[nodiscard]] std::optional<Breach> look(const engine::Vec2& h,
                                             const engine::ContactState& before,
                                             const engine::ContactState& after,
                                             const engine::Contact& contact);

    /// Walks that were held to the first root, and those where rounding left more than one stop.
    std::uint64_t walks = 0;
    std::uint64_t ties = 0;
    /// Closest points that needed no search.
    [[nodiscard]] std::uint64_t certified() const noexcept { return track_.certified; }

private:
    struct Tick {
        engine::Vec2 h{};
        engine::Contact contact{};
        engine::ClosestPoint cp{};  ///< as it is followed; the same tick's
        bool springy = false;       ///< the force was K (GO - HIP)
    };

    void check_free(const Tick& now);
    void check_closest(Tick& now);
    void check_force(const Tick& now);
    void check_walk(const Tick& now, const engine::ContactState& before);
    void check_first_root(const Tick& now,
                          const engine::ContactState& before,
                          const engine::ContactState& after);
    void check_step(const Tick& now);
    void check_recovery(const Tick& now);
    [[nodiscard]] double resolution(const engine::Place& place) const noexcept;
    [[nodiscard]] double turn_of_last_bits(const engine::Place& place) const noexcept;
    [[nodiscard]] bool at_open_end(const engine::Place& place) const noexcept;
    [[nodiscard]] bool on_knife_edge(const engine::Place& place) const noexcept;
    [[nodiscard]] bool on_end_normal(const engine::Place& place,
                                     const engine::Vec2& h) const noexcept;
    [[nodiscard]] bool in_corner(const engine::Contact& contact) const noexcept;

    const engine::Scene* scene_;
    engine::OutlineFeet feet_;
    ExactOutline exact_;
    engine::TrackState track_;
    double size_ = 0.0;    ///< diagonal of the control points, m
    double extent_ = 0.0;  ///< largest coordinate of the outline, m
    double same_ = 0.0;    ///< lengths nearer than this are the same in this tick, m
    bool after_refusal_ = false;
    bool last_far_ = false;  ///< the last tick was too far away to be looked at
    Tick last_{};
};

}  // namespace palpate::stress
