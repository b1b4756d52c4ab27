#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sched.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/rendering/mode.hpp"
#include "data/store/database.hpp"
#include "ui/command/command.hpp"
#include "ui/console/page_server.hpp"
#include "ui/live/live_segment.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/json_line.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

// As they lie in page/.
std::string_view console_page(), console_style(), console_script();

namespace {

namespace fs = std::filesystem;
using data::Json;

constexpr std::int64_t kLinger = 10'000 * kMillisecond;
constexpr std::int64_t kLookEvery = 500 * kMillisecond;
constexpr std::int64_t kSayEvery = 1000 * kMillisecond;
/// A session that did not answer for longer; while it proves a rig it does not for up to 1.8 s.
constexpr std::int64_t kHangs = 3000 * kMillisecond;

double seconds_since(std::int64_t then_ns) {
    return std::round(static_cast<double>(monotonic_ns() - then_ns) * 1e-8) / 10.0;
}

/// Since its log was last written to, ms; none: not known.
std::optional<std::int64_t> age_of_log(const std::string& database) {
    std::error_code none;
    auto written = fs::last_write_time(database + "-wal", none);
    written = none ? fs::last_write_time(database, none) : written;
    const auto age =
        std::chrono::floor<std::chrono::milliseconds>(decltype(written)::clock::now() - written);
    return none ? std::nullopt : std::optional(std::max<std::int64_t>(0, age.count()));
}

/// Values are rounded to what can be seen: 10 um, 1 mN, 0.1 mm/s.
double shown(double value, double per_unit) {
    const double rounded = std::round(value * per_unit) / per_unit;
    return std::isfinite(rounded) ? rounded : 0.0;
}

Json point(const engine::Vec3& at, double per_unit) {
    return {shown(at.x, per_unit), shown(at.y, per_unit)};
}

/// What is felt: in the memory only once it was revealed.
void add_felt(Json& event, const std::vector<LiveTick>& ticks) {
    constexpr double kPlace = 1e5;
    constexpr double kForce = 1e3;
    constexpr double kSpeed = 1e4;
    const engine::TickRecord& newest = ticks.back().tick;
    event["hip"] = point(newest.hip, kPlace);
    event["go"] = newest.mode == engine::Mode::free ? Json(nullptr) : point(newest.go, kPlace);
    event["f"] = point(newest.force, kForce);
    Json& strips = event["strips"];
    for (const auto& [tick, speed, force_on, felt, unused] : ticks) {
        strips["t"].push_back(shown(1e-9 * static_cast<double>(tick.time_ns), 1e4));
        strips["fn"].push_back(shown(tick.normal_force, kForce));
        strips["ft"].push_back(shown(tick.tangential_force, kForce));
        strips["speed"].push_back(shown(speed, kSpeed));
        strips["mode"].push_back(tick.mode == engine::Mode::transition ? "slip"
                                                                       : to_string(tick.mode));
    }
}

/// What all pages of one session share: the session, and what its file and its disk say beside.
class WatchedSession : public RunningSession {
public:
    /// @param acts  its pages may act
    WatchedSession(RunningSession session, bool acts)
        : RunningSession(std::move(session)), acts_(acts) {}

    /// Whether its program is there, and whether it does not answer.
    [[nodiscard]] std::pair<bool, bool> stands() const {
        const std::int64_t answered_ns = reader->answered_ns();
        return {alive(), answered_ns > 0 && monotonic_ns() - answered_ns > kHangs};
    }

    /// The state as the page takes it; empty: none could be read. Any thread.
    /// @param shown  with what is felt, once that was revealed
    [[nodiscard]] std::string state(bool shown) {
        const auto read = reader->state();
        Json state = object_in(read ? read->json : "");
        if (state.empty()) {
            return {};
        }
        const std::scoped_lock lock(mutex_);
        look_beside();
        const auto [there, hangs] = stands();
        state["phase_s"] = seconds_since(read->phase_ns);
        state["disk_free_mb"] = disk_free_mb_;
        state["saved_ms"] = json_or_null(written_ms_);
        state["seal"] = json_or_null(seal_);
        state["act"] = acts_;
        state["alive"] = there;
        state["silent_s"] = nullptr;
        if (!shown && state.erase("hidden") > 0) {
            state["reveal"] = "ask";
        }
        if (!there) {
            state["force"] = {{"on", false}, {"why", "the session's program is gone"}};
            if (state["ended"].is_null()) {
                state["ended"] = "killed";
            }
        } else if (hangs && state["ended"].is_null()) {
            state["silent_s"] = seconds_since(reader->answered_ns());
            state["force"] = {{"on", nullptr}, {"why", "the session does not answer"}};
        }
        return one_line(state);
    }

    /// Hands a line of the page on to the session. @return its answer. Any thread.
    /// @param gone  whoever asked: no force is all that is still done then
    [[nodiscard]] std::string ask(const std::string& line, bool gone) const {
        Json asked = object_in(line);
        if (!asked.contains("do") || (gone && asked["do"] != "stop")) {
            return answer_of(false, gone ? "nobody waits for it any more: nothing was done"
                                         : "one JSON object is taken: nothing was done");
        }
        asked["page"] = true;
        // The next session of the file has the name of one that is gone.
        const std::string answer = alive() ? ask_session(name, one_line(asked)).line : "";
        const char* why = !alive() ? "the session's program is gone: nothing was done"
                        : asked["do"] == "stop"
                            ? "the session did not answer within 2 s: hands off the handle, use "
                              "the switch of its motors; it gives no force when it goes on"
                            : "the session did not answer within 2 s: look whether it did what "
                              "was asked";
        return answer.empty() ? answer_of(false, why) : std::string(trimmed(answer, "\n"));
    }

private:
    /// A file that cannot be read says nothing.
    void look_beside() {
        if (monotonic_ns() - looked_ns_ < kLookEvery) {
            return;
        }
        looked_ns_ = monotonic_ns();
        written_ms_ = age_of_log(file);
        std::error_code unknown;
        const fs::space_info disk = fs::space(file, unknown);
        disk_free_mb_ =
            unknown ? disk_free_mb_ : std::floor(static_cast<double>(disk.available) / 1e6);
        try {
            if (!database_) {
                database_ = std::make_unique<data::Database>(file, data::Access::inspect);
            }
            data::Statement row =
                database_->prepare("SELECT newest_seal FROM session WHERE uuid = ?1", uuid);
            seal_ = row.step() ? row.text(0).substr(0, 16) : "";
        } catch (const std::exception&) {
            database_.reset();
        }
    }

    bool acts_;
    std::mutex mutex_;
    std::unique_ptr<data::Database> database_;
    std::int64_t looked_ns_ = 0;
    std::string seal_;
    double disk_free_mb_ = 0.0;
    std::optional<std::int64_t> written_ms_{};  ///< since something was; none: not known
};

/// Events of a session for one page: "state" at each change and at least once a second, "live"
/// with the newest tick, but for a still one; a blind page, on which nothing moves, hears of it when
/// the force goes on or off and beside each state: browsers compute where the servo does. A page
/// that did not ask for it shows nothing of what another one revealed. Ends with the session's
/// process.
struct SessionStream {
    std::shared_ptr<WatchedSession> watched_;
    bool shown_;
    bool still_;

    std::optional<std::string> operator()() {
        if (!stands_.first) {
            return std::nullopt;
        }
        const std::uint64_t version = watched_->reader->version();
        const auto stands = watched_->stands();
        const bool due =
            version != version_ || stands != stands_ || monotonic_ns() - said_ns_ > kSayEvery;
        std::string text = still_ ? "" : live(due);
        if (const std::string state = due ? watched_->state(shown_) : ""; !state.empty()) {
            version_ = version;
            stands_ = stands;
            said_ns_ = monotonic_ns();
            text += "event: state\ndata: " + state + "\n\n";
        }
        return text;
    }

    /// @param due  a state comes with it
    [[nodiscard]] std::string live(bool due) {
        const auto [ticks, count] = watched_->reader->ticks_after(ticks_);
        ticks_ = count;
        if (ticks.empty() || (!shown_ && ticks.back().force_on == force_on_ && !due)) {
            return {};
        }
        const LiveTick& newest = ticks.back();
        force_on_ = newest.force_on;
        Json event{{"t", shown(1e-9 * static_cast<double>(newest.tick.time_ns), 1e3)},
                   {"force_on", newest.force_on},
                   {"late_us", std::round(newest.tick.lateness_us)}};
        if (newest.felt && shown_) {
            add_felt(event, ticks);
        }
        return event_text("live", event);
    }

    std::uint64_t version_ = 1;  ///< odd: of no state
    std::uint64_t ticks_ = 0;
    std::int64_t said_ns_ = 0;
    bool force_on_ = false;
    std::pair<bool, bool> stands_{true, false};  ///< as was said: it is there, it hangs
};

struct ConsoleOptions {
    std::optional<std::string> of;
    std::string listen;
    std::vector<std::string> tls;
    bool act = false;
    bool while_runs = false;
};

void declare(CommandWords& words, ConsoleOptions& options) {
    words.add("SESSION", options.of,
              "Its database, or its uuid; without it the only one that runs on this machine");
    words
        .add("--listen", options.listen,
             "An address of this machine for other machines to look at, such as 192.168.1.5; they "
             "may only look")
        .needs("--tls");
    words.add("--tls", options.tls, "Certificate and key of that address, two PEM files")
        .needs("--listen");
    words.add("--act", options.act, "Other machines may act as well").needs("--listen");
    words.add("--while-runs", options.while_runs, "Ends 10 s after the session does");
}

RunningSession the_session(const std::optional<std::string>& of) {
    std::vector<RunningSession> all = running_sessions(of);
    refuse_if(all.empty(), "{}",
              of ? fmt::format("{}: no session of yours that answers runs on it, and none has that "
                               "uuid; palpate status says whether one hangs",
                               *of)
                 : std::string("no session of yours that answers runs: begin one with palpate "
                               "run"));
    if (all.size() > 1) {
        std::string text = "several sessions run; name one of these:";
        for (const RunningSession& one : all) {
            text += fmt::format("\n    palpate console {}  ({})", one.uuid, one.file);
        }
        throw std::invalid_argument(text);
    }
    return std::move(all.front());
}

/// That of every page of the session, which holds it: one that was open goes on with this server.
void take_address(const std::string& session, PageServerSpec& spec) {
    Received held = ask_session(session, R"({"do":"page"})");
    const data::Json said = object_in(held.line);
    if (said.value("ok", false)) {
        spec.listening = std::move(held.file);
        spec.token = said.value("token", "");
        spec.cookie = said.value("cookie", "");
    }
}

/// @param holds  what a PEM file of its kind has
std::string pem_text(const std::string& file, std::string_view holds) {
    std::error_code none;
    std::string text = std::filesystem::is_regular_file(file, none) ? file_text(file) : "";
    refuse_if(text.find(holds) == std::string::npos,
              "{}: {}; --tls takes a certificate and its key, two PEM files: openssl req -x509 "
              "-nodes -newkey rsa:2048 -addext subjectAltName=IP:ADDRESS -subj /CN=palpate -keyout "
              "KEY -out CERT makes them",
              file,
              text.empty() ? "no file that can be read is there"
                           : fmt::format("has no line \"-----BEGIN ... {}\"", holds));
    return text;
}

int run(const ConsoleOptions& options) {
    catch_signals();
    const sched_param usual{};
    sched_setscheduler(0, SCHED_BATCH, &usual);  // whoever wakes goes first: the session
    refuse_if(!options.tls.empty() && options.tls.size() != 2,
              "--tls takes two files: --tls CERT KEY");
    PageServerSpec spec;
    const bool acts = options.listen.empty() || options.act;
    if (!options.listen.empty()) {
        spec.address = options.listen;
        spec.certificate = pem_text(options.tls[0], "CERTIFICATE-----");
        spec.key = pem_text(options.tls[1], "PRIVATE KEY-----");
    }
    auto watched = std::make_shared<WatchedSession>(the_session(options.of), acts);
    if (options.listen.empty()) {
        take_address(watched->name, spec);
    }
    spec.file = [](std::string_view path) {
        return std::string(path == "/"              ? console_page()
                           : path == "/console.css" ? console_style()
                           : path == "/console.js"  ? console_script()
                                                    : "");
    };
    spec.open = [watched, acts](bool shown, bool still) {
        return SessionStream{watched, shown && acts, still};  // who may only look reveals nothing
    };
    if (acts) {
        spec.act = std::bind_front(&WatchedSession::ask, watched);
    }
    const PageServer server(std::move(spec));
    say("The experimenter's page, for your eyes alone: {}\nCtrl+C {}.\n", server.address(),
        options.while_runs
            ? "at the session's terminal ends the session, and 10 s after it the page"
            : "ends it; the session goes on");
    std::int64_t seen_ns = monotonic_ns();
    while (!interrupted() && (!options.while_runs || monotonic_ns() - seen_ns < kLinger)) {
        seen_ns = watched->alive() ? monotonic_ns() : seen_ns;
        sleep_until(monotonic_ns() + 200 * kMillisecond);
    }
    return 0;
}

}  // namespace

Command console_command() {
    return make_command<ConsoleOptions>(
        "console", "Serve a page on a running session to your browser", declare, run);
}

}  // namespace palpate::ui
