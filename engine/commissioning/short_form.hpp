#pragma once

#include <string>

namespace palpate::engine {

class PulseRunner;
struct Calibration;
struct RigRecord;

/// What the short form of a rig's proof came to: that its handle rests where it should, or that it
/// moves as it did.
struct ShortForm {
    std::string refused;  ///< why not, a sentence without a full stop; empty: the rig is proved
    std::string found;    ///< shares and directions of those that were right, for the record
};

/// The short form that opens each session, and is given again in its breaks: a pulse in each
/// direction where the handle rests, until one says that something is wrong.
[[nodiscard]] ShortForm prove_again(PulseRunner& runner,
                                    const Calibration& machine,
                                    const RigRecord& record,
                                    double delay);

}  // namespace palpate::engine
