#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocols/trial/presentation.hpp"
#include "ui/session/open_apparatus.hpp"

namespace palpate::ui {

/// By its name on the page.
using FeltStimulus = std::pair<std::string, protocols::Presentation>;

/// What a protocol lets one feel, one stimulus at a time as whoever looks at its preview asks for
/// it: by the same servo and safety chain as in a pilot, and nothing is kept.
class FeltStimuli {
public:
    /// One that nobody ended ends then.
    static constexpr double kLongest = 30.0;  // s

    /// @param rig  its device, rig and handle_free; of the study nothing yet
    /// @param device  as --device has it, and so `calibration`
    /// @throws std::invalid_argument for a device that cannot be felt without a window
    FeltStimuli(std::string protocol,
                RigSpec rig,
                std::string device,
                const std::string& calibration);

    /// {"device": "sim", "stimuli": ["convex, friction off", ...], "on": 3 or null, "said": "..."}
    /// as an event of the page. Any thread.
    [[nodiscard]] std::string event() const;
    /// {"do": "feel", "at": 3} or {"do": "stop"}. Any thread. @return {"ok": ..., "text": ...}
    /// @param gone  whoever asked: nothing is felt for them
    [[nodiscard]] std::string ask(const std::string& line, bool gone);

    /// The protocol was saved: the device is opened anew for it when something is asked for.
    void read_again();
    /// Lets what was asked for be felt until its end; what goes wrong is said, not thrown. On the
    /// thread that made it.
    void feel_asked();

private:
    void feel(const FeltStimulus& one);
    void say_on_page(std::optional<std::size_t> on, std::string text);

    std::string protocol_;
    RigSpec rig_;
    std::string device_;
    std::optional<OpenedApparatus> opened_;

    mutable std::mutex mutex_;
    std::vector<FeltStimulus> stimuli_;
    std::optional<std::size_t> asked_;
    std::optional<std::size_t> on_;
    std::string said_;
    std::atomic<bool> stop_{false};
};

}  // namespace palpate::ui
