#include "protocols/observer/outline_cues.hpp"

#include <algorithm>
#include <cmath>

#include "protocols/design/object_outline.hpp"
#include "protocols/observer/cues.hpp"

namespace palpate::protocols {

OutlineCues::OutlineCues(const Protocol& protocol, const std::vector<std::size_t>& pictures)
    : softness_(1.0 / protocol.apparatus.stiffness) {
    for (const std::size_t object : pictures) {
        if (protocol.surface) {
            surfaces_.emplace_back(surface_of(protocol, protocol.objects.at(object)));
            continue;
        }
        outlines_.push_back(outline_of(protocol, object));
        feet_.emplace_back(*outlines_.back());
    }
    forget();
}

void OutlineCues::forget() noexcept {
    squares_.assign(feet_.size() + surfaces_.size(), 0.0);
    tracks_.assign(surfaces_.size(), {});
    points_ = 0.0;
    tick_ = 0;
}

void OutlineCues::add(std::span<const engine::TickRecord> ticks) noexcept {
    for (const engine::TickRecord& tick : ticks) {
        const double pressed = glm::length(tick.force);
        if (tick.mode == engine::Mode::free || !(pressed > kFeltForce) || tick_++ % kEach != 0) {
            continue;
        }
        const engine::Vec3 felt = tick.hip + softness_ * tick.force;
        for (std::size_t i = 0; i < surfaces_.size(); ++i) {
            const double away = surfaces_[i].track(tracks_[i], felt).distance;
            squares_[i] += away * away;
        }
        const engine::Vec2 surface(felt);
        for (std::size_t i = 0; i < feet_.size(); ++i) {
            const double away = feet_[i].closest(surface).distance;
            squares_[i] += away * away;
        }
        points_ += 1.0;
    }
}

std::vector<double> OutlineCues::misfits() const {
    std::vector<double> misfits(squares_.size(), 0.0);
    if (felt()) {
        std::transform(squares_.begin(), squares_.end(), misfits.begin(),
                       [this](double square) { return std::sqrt(square / points_); });
    }
    return misfits;
}

}  // namespace palpate::protocols
