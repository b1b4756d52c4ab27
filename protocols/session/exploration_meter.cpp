#include "protocols/session/exploration_meter.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::protocols {
namespace {

/// The last segment, where it is one line from the outline's end back to its start.
bool is_base(const engine::Outline& outline, std::size_t span) noexcept {
    const std::size_t last = outline.spans().size() - 1;
    return outline.closed() && span == last && outline.name(span).segment > 0 &&
           outline.spans()[span].degree() == 1;
}

/// t from F = fn n + ft t, where n is t turned to the left; not normalised. 0 without a force.
engine::Vec2 along(const engine::TickRecord& tick) noexcept {
    const double fn = tick.normal_force;
    const double ft = tick.tangential_force;
    const engine::Vec2 f(tick.force);
    return {ft * f.x + fn * f.y, ft * f.y - fn * f.x};
}

}  // namespace

Deciles deciles_of(std::vector<double> values) noexcept {
    auto smallest = [&, from = values.begin()](std::size_t tenths) mutable {
        const std::size_t rank = (tenths * values.size() + 9) / 10;  // ceil, without a rounding
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
        std::nth_element(from, at, values.end());
        from = at;  // what lies before is smaller
        return *at;
    };
    return values.empty() ? Deciles{} : Deciles{smallest(1), smallest(5), smallest(9)};
}

OutlineCover::OutlineCover(const engine::Outline& outline) {
    constexpr std::size_t kSteps = 64;  // to measure a span
    for (std::size_t i = 0; i < outline.spans().size() && !is_base(outline, i); ++i) {
        const engine::RationalBezier<2>& span = outline.spans()[i];
        const engine::SpanName& name = outline.name(i);
        if (name.segment == first_.size()) {
            first_.push_back(cells_.size());
        }
        engine::Vec2 last = span.at(0.0).point;
        Cell cell{.segment = static_cast<std::int16_t>(name.segment)};
        for (std::size_t k = 1; k <= kSteps; ++k) {
            const double t = static_cast<double>(k) / kSteps;
            const engine::Vec2 point = span.at(t).point;
            cell.length += glm::length(point - last);
            cell.end = name.parameter(t);
            last = point;
            if (cell.length >= kCell || k == kSteps) {
                cells_.push_back(cell);
                cell.length = 0.0;
            }
        }
    }
    first_.push_back(cells_.size());
}

void OutlineCover::add(const engine::TickRecord& tick) noexcept {
    if (tick.mode == engine::Mode::free) {
        return;
    }
    const bool on_vertex = tick.segment < 0;
    const auto segment = static_cast<std::size_t>(on_vertex ? -1 - tick.segment : tick.segment);
    if (segment + 1 >= first_.size()) {
        return;  // the base
    }
    const std::size_t low = first_[segment];
    const std::size_t high = first_[segment + 1];
    if (on_vertex) {
        at_ = high - 1;
    } else if (at_ < low || at_ >= high || tick.u > cells_[at_].end ||
               (at_ > low && tick.u <= cells_[at_ - 1].end)) {
        const auto from = cells_.begin() + static_cast<std::ptrdiff_t>(low);
        const auto found =
            std::partition_point(from, cells_.begin() + static_cast<std::ptrdiff_t>(high - 1),
                                 [&](const Cell& cell) { return cell.end < tick.u; });
        at_ = static_cast<std::size_t>(found - cells_.begin());
    }
    cells_[at_].visited = true;
}

double OutlineCover::share() const noexcept {
    double visited = 0.0;
    double all = 0.0;
    for (const Cell& cell : cells_) {
        visited += cell.visited ? cell.length : 0.0;
        all += cell.length;
    }
    return all > 0.0 ? visited / all : 0.0;
}

void PatchCover::add(const engine::TickRecord& tick) noexcept {
    const auto cell = [](double parameter) {
        return std::floor((parameter - 1.0) * static_cast<double>(kSide));
    };
    const double i = cell(tick.u);
    const double j = cell(tick.v);
    constexpr auto kEnd = static_cast<double>(kSide);
    if (i >= 0.0 && i < kEnd && j >= 0.0 && j < kEnd) {
        visited_[static_cast<std::size_t>(i) * kSide + static_cast<std::size_t>(j)] = true;
    }
}

double PatchCover::share() const noexcept {
    const auto visited = std::count(visited_.begin(), visited_.end(), true);
    return static_cast<double>(visited) / static_cast<double>(visited_.size());
}

engine::Vec2 StrokeCounter::step_to(const engine::TickRecord& tick) noexcept {
    const engine::Vec2 hip(tick.hip);
    const engine::Vec2 step = started_ ? hip - last_hip_ : engine::Vec2{};
    started_ = true;
    last_hip_ = hip;
    return step;
}

/// A tick in contact: after a lift a stroke begins anew.
void StrokeCounter::touch(const engine::TickRecord& tick) noexcept {
    if (tick.time_ns - last_contact_ > kLift) {
        direction_ = 0;
        place_ = low_ = high_ = 0.0;
    }
    last_contact_ = tick.time_ns;
}

void StrokeCounter::add(const engine::TickRecord& tick) noexcept {
    const engine::Vec2 step = step_to(tick);
    if (tick.mode == engine::Mode::free) {
        return;
    }
    touch(tick);
    segment_ = tick.segment >= 0 ? tick.segment : segment_;
    const engine::Vec2 t = along(tick);
    const double length = glm::length(t);
    if (length > 0.0) {
        go(glm::dot(step, t) / length);
    }
}

void StrokeCounter::add_along(const engine::TickRecord& tick, const engine::Vec2& axis) noexcept {
    const engine::Vec2 step = step_to(tick);
    if (tick.mode != engine::Mode::free) {
        touch(tick);
        go(glm::dot(step, axis));
    }
}

void StrokeCounter::go(double step) noexcept {
    place_ += step;
    low_ = std::min(low_, place_);
    high_ = std::max(high_, place_);
    if (direction_ <= 0 && place_ - low_ >= kStroke) {
        count(1);
        high_ = place_;
    } else if (direction_ >= 0 && high_ - place_ >= kStroke) {
        count(-1);
        low_ = place_;
    }
}

void StrokeCounter::count(int direction) noexcept {
    ++strokes_;
    reversals_ += direction_ != 0 ? 1 : 0;
    if (segment_ == 0 || segment_ == 1) {
        ++on_side_[static_cast<std::size_t>(segment_)];
    }
    direction_ = direction;
}

}  // namespace palpate::protocols
