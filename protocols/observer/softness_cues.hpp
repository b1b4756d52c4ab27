#pragma once

#include <memory>
#include <optional>
#include <span>

#include "engine/contact/closest_point.hpp"
#include "engine/realtime/tick_record.hpp"
#include "protocols/protocol/protocol.hpp"

namespace palpate::protocols {

/// How soft the object of a rule feels, from the ticks of one interval alone.
///
/// The hand knows the object's shape at rest, and so how far below it it is, d; and the force F
/// that presses it back. Softness is how far one sinks in by a newton, by least squares through no
/// force at no depth:
///
///     softness = sum |F| d / sum |F|^2, m/N
///
/// of every kEach-th tick in which HIP is below the shape at rest and the force 0.05 N or more. On
/// a contact of stiffness K that is 1 / K and what the surface gives way by, less beside the ends
/// than at the vertex. Ticks do not say how soft the object was meant to be, and the columns of the
/// god-object are not read.
class SoftnessCues {
public:
    static constexpr int kEach = 5;

    /// @pre the protocol has a rule
    explicit SoftnessCues(const Protocol& protocol);

    /// The next ticks, in their order: of every kEach-th one force and depth, where HIP is inside.
    void add(std::span<const engine::TickRecord> ticks) noexcept;
    /// m/N; nothing if nothing was pressed.
    [[nodiscard]] std::optional<double> softness() const noexcept;

private:
    struct Rest;
    std::shared_ptr<const Rest> rest_;
    double product_ = 0.0;  ///< of |F| and d, N m
    double squares_ = 0.0;  ///< of |F|, N^2
    int tick_ = 0;
};

}  // namespace palpate::protocols
