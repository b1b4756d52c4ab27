#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/device/device.hpp"
#include "engine/device/five_bar.hpp"
#include "engine/geometry/vec.hpp"
#include "engine/realtime/lateness_histogram.hpp"
#include "engine/realtime/realtime_rights.hpp"
#include "protocols/protocol/protocol.hpp"

/// Each looks at one thing and returns what it found. They print nothing.
namespace palpate::ui {

/// What a check came to.
enum class CheckStatus : std::uint8_t {
    ok,
    warn,  ///< sessions run, but something is worse than it could be
    fail,  ///< sessions will not run, or not as recorded
};

/// One line of the doctor's.
struct Check {
    std::string name;
    CheckStatus status = CheckStatus::ok;
    std::string detail{};  ///< what was found, with numbers and units
    std::string remedy{};  ///< what to do; empty when all is well
    std::vector<std::pair<std::string, double>> numbers{};  ///< for programs: "p99_us", 35.2
    std::vector<std::string> picture{};                     ///< lines below, for people only

    /// Not all is well: what to do.
    void warns(std::string advice) { status = CheckStatus::warn, remedy = std::move(advice); }
    void fails(std::string advice) { status = CheckStatus::fail, remedy = std::move(advice); }
};

/// `look`, or a failed check named `name` with what it threw.
[[nodiscard]] Check guarded(const std::string& name, const std::function<Check()>& look) noexcept;

/// Some check failed.
[[nodiscard]] bool any_fails(const std::vector<Check>& checks) noexcept;

/// "ok", "warn", "fail".
[[nodiscard]] std::string_view to_string(CheckStatus status) noexcept;

/// One check as people read it: a line, the remedy below it behind an arrow, then the picture.
[[nodiscard]] std::string as_text(const Check& check);
/// The last line: how many of each.
[[nodiscard]] std::string verdict(const std::vector<Check>& checks);

/// One JSON object: {"palpate": version, "checks": [{"name", "status", "detail", "remedy",
/// "numbers": {...}}]}. Valid whatever the texts hold: what is not UTF-8 becomes a question mark,
/// a number that is not finite becomes null.
[[nodiscard]] std::string as_json(std::string_view version, const std::vector<Check>& checks);

// --- device_checks.cpp

/// For who reads the device once more while it is open; and how it is opened.
using LookAgain = std::function<void(const engine::Device&)>;
using OpenDevice = std::function<std::shared_ptr<engine::Device>()>;

/// Opens the device, writes zero force, reads it for 0.2 s, writes zero force again. Of a board
/// that is asked and answers: how long an answer took when it was opened.
/// @param word  as --device has it, for the text
/// @param open  may throw: what it says becomes the remedy
/// @param start  where the handle starts, object frame, m
/// @param then  called with the device if it could be opened and read
[[nodiscard]] Check check_device(const std::string& word,
                                 const OpenDevice& open,
                                 const engine::Vec3& start,
                                 const LookAgain& then = {});

/// Can the device render this protocol (protocols::check_feasibility), and by what margin?
[[nodiscard]] Check check_feasible(const protocols::Protocol& protocol,
                                   const engine::Device& device);

/// A linkage and where its handle works.
struct Linkage {
    std::string name;
    engine::FiveBar bars{};
    engine::Vec2 centre{};          ///< of the workspace, linkage frame, m
    engine::Vec2 half{0.04, 0.03};  ///< half of its width and height, m
};

/// inverse then forward over a grid of the workspace, and the Jacobian against central differences.
[[nodiscard]] Check check_kinematics(std::span<const Linkage> linkages);

// --- wake_up.cpp. cyclictest of rt-tests is the usual measure of wake-up latency on Linux, and never
// needed: where it is not installed there is nothing to compare with.

/// Its histogram of wake-up latencies.
struct Cyclictest {
    std::vector<std::int64_t> counts;  ///< counts[k]: latencies of k to k + 1 us
    std::int64_t overflows = 0;        ///< beyond the last bin
    double max_us = 0.0;

    /// Cycles, overflows counted.
    [[nodiscard]] std::int64_t total() const;
    /// Lateness that `share` of the cycles do not exceed, us; between the ends of a bin by
    /// proportion. max_us among the overflows, 0 without cycles.
    [[nodiscard]] double quantile_us(double share) const;
};

/// Reads what `cyclictest -q -h` prints, one thread. None if that is no such output, or without a
/// cycle.
[[nodiscard]] std::optional<Cyclictest> parse_cyclictest(std::string_view output);

/// It is on the PATH.
[[nodiscard]] bool cyclictest_installed();

/// Runs it: one thread, absolute sleeps on CLOCK_MONOTONIC.
/// @param rate_hz   100 to 100,000
/// @param realtime  with -m -p80, as a servo with all its rights; without: as an ordinary program
/// @return none if it is not installed or gave nothing (no right to real-time priority)
[[nodiscard]] std::optional<Cyclictest> run_cyclictest(double rate_hz,
                                                       double seconds,
                                                       bool realtime);

/// What a servo thread was like for a while.
struct WakeUps {
    engine::LatenessHistogram lateness{};
    engine::RealtimeRights rights{};
    double processor_share = 0.0;  ///< of one processor, the thread that waits for it included
};

/// Runs the servo's own thread, with a device that does nothing and a scene that is out of reach.
/// @param rate_hz     1000 to 10000
/// @param seconds     > 0
/// @param spin_share  see engine::ServoSpec
[[nodiscard]] WakeUps measure_wake_ups(double rate_hz,
                                       double seconds,
                                       const engine::RealtimeWish& wish,
                                       double spin_share = 0.0);

// --- timing_checks.cpp

/// Resolution, steps back and the cost of CLOCK_MONOTONIC, and what the kernel reads it from.
[[nodiscard]] Check check_clock();

/// One check a right, as granted to a servo thread.
[[nodiscard]] std::vector<Check> check_rights(const engine::RealtimeRights& rights);

/// Our loop and cyclictest in turns: five rounds of each.
struct JitterRun {
    double rate_hz = 0.0;
    WakeUps all;                     ///< of ours, the rounds together
    std::vector<double> p50_ratios;  ///< ours / cyclictest, a round each; empty without cyclictest
    std::vector<double> p99_ratios;
    bool installed = false;  ///< cyclictest
};
/// @param seconds  of ours altogether, > 0; cyclictest takes as long again
[[nodiscard]] JitterRun run_jitter(double rate_hz, double seconds);
[[nodiscard]] Check check_jitter(const JitterRun& run);
[[nodiscard]] Check check_cyclictest(const JitterRun& run);

/// Counts of a histogram in bars, for people.
[[nodiscard]] std::vector<std::string> bars(const engine::LatenessHistogram& histogram);

// --- host_checks.cpp

/// Processor time since boot, in ticks of the kernel.
struct ProcessorTime {
    double all = 0.0;
    double stolen = 0.0;  ///< taken by other guests of a virtual machine's host
};
/// None where there is no /proc/stat.
[[nodiscard]] std::optional<ProcessorTime> processor_time();

/// Its name, and whether it is a real-time kernel; never a warning.
[[nodiscard]] Check check_kernel();
/// @param before  processor_time() some seconds ago
[[nodiscard]] Check check_host(const std::optional<ProcessorTime>& before);
/// Room and sync time of the folder that `database` is in, or would be, wherever links lead. Fails
/// for what is there and no database.
[[nodiscard]] Check check_disk(const std::string& database);

// --- screen_checks.cpp: the only ones with SDL

/// The display and the sound device that a session would get; nothing is shown or played.
/// @param needed  a person holds the device: run refuses where no display is named
[[nodiscard]] Check check_display(bool needed);
[[nodiscard]] Check check_audio();
/// @param asked  a TrueType file; empty: the system's
[[nodiscard]] Check check_font(const std::string& asked);

}  // namespace palpate::ui
