#pragma once

#include <cstdint>
#include <span>

/// What the fuzzers feed: any bytes are fine, and nothing but a documented refusal may come of them. A
/// law that does not hold ends the program (std::abort), so that a fuzzer and a test both see it.
namespace palpate::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Bytes as NURBS curves and a surface, felt for a few ticks: closest points, contacts, finite forces.
void feel_geometry(Bytes bytes);

/// Bytes as the text of a scene file; what it describes is felt.
void read_scene(Bytes bytes);

/// Bytes as a CSV of a trajectory.
void read_csv(Bytes bytes);

/// Bytes as a protocol file; what was read must read back from its own text.
void read_protocol(Bytes bytes);

}  // namespace palpate::fuzz
