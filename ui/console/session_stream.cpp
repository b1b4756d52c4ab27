#include "ui/console/session_stream.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "engine/rendering/mode.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/json_line.hpp"

namespace palpate::ui {
namespace {

namespace fs = std::filesystem;
using data::Json;

constexpr std::int64_t kLookEvery = 500 * kMillisecond;
constexpr std::int64_t kSayEvery = 1000 * kMillisecond;

double seconds_since(std::int64_t then_ns) {
    return std::round(static_cast<double>(monotonic_ns() - then_ns) * 1e-8) / 10.0;
}

/// Since its log was last written to, ms; < 0: not known.
std::int64_t age_of_log(const std::string& database) {
    std::error_code none;
    auto written = fs::last_write_time(database + "-wal", none);
    written = none ? fs::last_write_time(database, none) : written;
    const auto age =
        std::chrono::floor<std::chrono::milliseconds>(decltype(written)::clock::now() - written);
    return none ? -1 : std::max<std::int64_t>(0, age.count());
}

/// Values are rounded to what can be seen: 10 um, 1 mN, 0.1 mm/s.
double shown(float value, double per_unit) {
    const double rounded = std::round(double{value} * per_unit) / per_unit;
    return std::isfinite(rounded) ? rounded : 0.0;
}

Json point(const std::array<float, 2>& at, double per_unit) {
    return {shown(at[0], per_unit), shown(at[1], per_unit)};
}

/// What is felt: in the memory only once it was revealed.
void add_felt(Json& event, const std::vector<LiveTick>& ticks) {
    constexpr double kPlace = 1e5;
    constexpr double kForce = 1e3;
    constexpr double kSpeed = 1e4;
    const LiveTick& newest = ticks.back();
    const bool free = newest.mode == static_cast<std::uint8_t>(engine::Mode::free);
    event["hip"] = point(newest.hip, kPlace);
    event["go"] = free ? Json(nullptr) : point(newest.go, kPlace);
    event["f"] = point(newest.force, kForce);
    Json strips{{"t", Json::array()},
                {"fn", Json::array()},
                {"ft", Json::array()},
                {"speed", Json::array()},
                {"mode", Json::array()}};
    for (const LiveTick& tick : ticks) {
        strips["t"].push_back(std::round(tick.t_s * 1e4) / 1e4);
        strips["fn"].push_back(shown(tick.normal, kForce));
        strips["ft"].push_back(shown(tick.tangential, kForce));
        strips["speed"].push_back(shown(tick.speed, kSpeed));
        const auto mode = static_cast<engine::Mode>(tick.mode);
        strips["mode"].push_back(mode == engine::Mode::transition ? "slip" : to_string(mode));
    }
    event["strips"] = std::move(strips);
}

}  // namespace

WatchedSession::WatchedSession(RunningSession session, bool acts)
    : session_(std::move(session)), acts_(acts) {}

/// A file that cannot be read says nothing.
void WatchedSession::look_beside() {
    if (monotonic_ns() - looked_ns_ < kLookEvery) {
        return;
    }
    looked_ns_ = monotonic_ns();
    written_ms_ = age_of_log(session_.file);
    std::error_code unknown;
    const fs::space_info disk = fs::space(session_.file, unknown);
    disk_free_mb_ = unknown ? disk_free_mb_ : std::floor(static_cast<double>(disk.available) / 1e6);
    try {
        if (!database_) {
            database_ = std::make_unique<data::Database>(session_.file, data::Access::inspect);
        }
        data::Statement row =
            database_->prepare("SELECT newest_seal FROM session WHERE uuid = ?1", session_.uuid);
        seal_ = row.step() ? row.text(0).substr(0, 16) : "";
    } catch (const std::exception&) {
        database_.reset();
    }
}

std::string WatchedSession::state(bool shown) {
    const auto read = session_.reader->state();
    Json state = object_in(read ? read->json : "");
    if (state.empty()) {
        return {};
    }
    const std::scoped_lock lock(mutex_);
    look_beside();
    const bool there = alive();
    state["phase_s"] = seconds_since(read->phase_ns);
    state["disk_free_mb"] = disk_free_mb_;
    state["saved_ms"] = written_ms_ < 0 ? Json(nullptr) : Json(written_ms_);
    state["seal"] = json_or_null(seal_);
    state["act"] = acts_;
    state["alive"] = there;
    if (!shown && state.erase("hidden") > 0) {
        state["reveal"] = "ask";
    }
    if (!there) {
        state["force"] = {{"on", false}, {"why", "the session's program is gone"}};
        if (state["ended"].is_null()) {
            state["ended"] = "killed";
        }
    }
    return one_line(state);
}

std::string WatchedSession::ask(const std::string& line, bool gone) const {
    Json asked = object_in(line);
    if (!asked.contains("do") || (gone && asked["do"] != "stop")) {
        return answer_of(false, gone ? "nobody waits for it any more: nothing was done"
                                     : "one JSON object is taken: nothing was done");
    }
    asked["page"] = true;
    // The next session of the file has the name of one that is gone.
    std::string answer = alive() ? ask_session(session_.name, one_line(asked)).line : "";
    while (answer.ends_with('\n')) {
        answer.pop_back();
    }
    return !answer.empty() ? answer
                           : answer_of(false, alive() ? "the session did not answer within 2 s: "
                                                        "look whether it did what was asked"
                                                      : "the session's program is gone: nothing "
                                                        "was done");
}

std::string SessionStream::live() {
    const auto [ticks, count] = watched_->session().reader->ticks_after(ticks_);
    ticks_ = count;
    if (ticks.empty()) {
        return {};
    }
    const LiveTick& newest = ticks.back();
    Json event{{"t", std::round(newest.t_s * 1e3) / 1e3},
               {"force_on", newest.force_on},
               {"late_us", std::round(newest.late_us)}};
    if (newest.felt && shown_) {
        add_felt(event, ticks);
    }
    return event_text("live", event);
}

std::string SessionStream::next() {
    std::string text = still_ ? "" : live();
    const std::uint64_t version = watched_->session().reader->version();
    const bool alive = watched_->alive();
    if (version != version_ || alive != alive_ || monotonic_ns() - said_ns_ > kSayEvery) {
        if (const std::string state = watched_->state(shown_); !state.empty()) {
            version_ = version;
            alive_ = alive;
            said_ns_ = monotonic_ns();
            text += "event: state\ndata: " + state + "\n\n";
        }
    }
    return text;
}

}  // namespace palpate::ui
