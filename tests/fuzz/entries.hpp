#pragma once

#include <cstdio>
#include <cstdlib>

#include "tests/support/std.hpp"

/// What the fuzzers feed: any bytes are fine, and nothing but a documented refusal may come of
/// them. A law that does not hold ends the program (std::abort), so that a fuzzer and a test both
/// see it.
namespace palpate::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Bytes as NURBS curves and a surface, felt for a few ticks: closest points, contacts, finite
/// forces.
void geometry(Bytes bytes);

// Bytes as the text of a file. What was read reads back from its own text, where it has one.
void scene(Bytes bytes);  ///< and what it describes is felt
void csv(Bytes bytes);    ///< of a trajectory
void protocol(Bytes bytes);
void procedure(Bytes bytes);
void observer(Bytes bytes);
void deformation(Bytes bytes);
void calibration(Bytes bytes);

/// Bytes as a chunk of ticks: what its row says, then its data.
void chunk(Bytes bytes);
/// Bytes as they come from a board: answers of the Haply, frames and datagrams of the open one.
void wire(Bytes bytes);

struct Entry {
    std::string_view name;  ///< of its folder in corpus/, and of its fuzzer after "fuzz_"
    void (*feed)(Bytes);
    bool text;
};
inline constexpr std::array kEntries{Entry{"geometry", geometry, false},
                                     Entry{"scene", scene, true},
                                     Entry{"csv", csv, true},
                                     Entry{"protocol", protocol, true},
                                     Entry{"procedure", procedure, true},
                                     Entry{"observer", observer, true},
                                     Entry{"deformation", deformation, true},
                                     Entry{"calibration", calibration, true},
                                     Entry{"chunk", chunk, false},
                                     Entry{"wire", wire, false}};

/// Ends the program, with what was broken, if a law does not hold.
inline void demand(bool holds, const char* law) {
    if (!holds) {
        std::fprintf(stderr, "broken: %s\n", law);
        std::abort();
    }
}

}  // namespace palpate::fuzz
