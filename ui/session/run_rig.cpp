#include "ui/session/run_rig.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <ranges>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/realtime/servo.hpp"
#include "protocols/design/adaptive_plan.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/keys.hpp"
#include "protocols/session/trust.hpp"
#include "data/store/async_recorder.hpp"
#include "data/store/chain.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "ui/live/live_session.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/operator_log.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/begin_session.hpp"
#include "ui/session/rig_parts.hpp"
#include "ui/sound/masked_observer.hpp"
#include "ui/subject/display.hpp"

namespace palpate::ui {
namespace {

using protocols::PlannedTrial;
using protocols::TrialResult;

/// What was felt and answered: of simulated sessions only.
std::string answer_text(const protocols::Protocol& protocol,
                        const PlannedTrial& planned,
                        const TrialResult& result) {
    const protocols::Response& response = *result.response;
    std::string text = planned.adaptive
                         ? fmt::format("{:<11}", protocol.runs.at(planned.adaptive->run).name)
                         : fmt::format("{:<11} friction {:<4}",
                                       protocol.objects.at(planned.condition.object).name,
                                       protocol.frictions.at(planned.condition.friction).name);
    if (result.step) {
        text += fmt::format(" {} {:<7.4g}", word_of(protocol.procedure->varies),
                            felt_value(*protocol.procedure, result.step->answer.stimulus));
    }
    text += response.object ? fmt::format(" -> {:<11}", protocol.objects.at(*response.object).name)
                            : fmt::format(" -> {}", response.place + 1);
    if (response.correct) {
        text += *response.correct ? " correct" : " wrong";
    }
    if (result.step && !result.step->estimates.empty() && result.step->estimates.front().mean) {
        text += fmt::format("  {} {:.4g}", result.step->estimates.front().name,
                            *result.step->estimates.front().mean);
    }
    return text;
}

/// What may be said of an attempt's answer. Who is at this terminal talks to the participant, or is
/// one: contact and force tell the shape and the friction.
std::string answer_line(const RigSpec& spec, const protocols::Progress& progress) {
    const protocols::TrialResult& result = progress.result;
    if (!result.response) {
        return {};
    }
    return !held_by_a_person(spec.device.kind)
             ? answer_text(spec.study.protocol, progress.planned, result)
             : fmt::format("felt {:.1f} s, {}answered in {:.1f} s", result.done_s,
                           result.summary.contact_ticks == 0 ? "never touched, " : "",
                           result.response->reaction_s);
}

double now_s() {
    return static_cast<double>(monotonic_ns()) * 1e-9;
}

/// Says what this run came to when it is over, however it ends; after the last answer is on the
/// disk.
class SummaryAtEnd {
public:
    SummaryAtEnd(data::Database& database, const data::OpenedSession& opened, const RigSpec& spec)
        : database_(database),
          session_(opened.id),
          after_(opened.last_trial),
          announced_(!spec.go_on.empty()) {}
    SummaryAtEnd(const SummaryAtEnd&) = delete;
    SummaryAtEnd& operator=(const SummaryAtEnd&) = delete;
    ~SummaryAtEnd() {
        try {
            if (announced_) {
                say("{}", run_summary(database_, session_, after_, (now_s() - begun_s_) / 60.0));
            }
        } catch (const std::exception&) {  // a file that is gone: why is said by what ended the run
        }
    }

private:
    data::Database& database_;
    std::int64_t session_;
    std::int64_t after_;
    bool announced_;
    double begun_s_ = now_s();
};

/// What whoever runs a session needs while it runs, and after it.
/// @param screen  a person sits at one. (To ask wants_window() now would close its window.)
void print_help(const data::Database& database, const RigSpec& spec, bool screen) {
    if (spec.go_on.empty()) {
        return;
    }
    if (screen) {
        say("At the participant's screen: Ctrl+Shift+Q then Y ends the session; Ctrl+Shift+M then "
            "Y: the trial does not count;\nCtrl+Shift+P pauses before the next trial, and goes on; "
            "Escape switches the force off. So do Escape and Enter here, and palpate stop from any "
            "shell.\n");
    }
    say("Data: {}\nIf it ends early, this goes on: {}\n",
        std::filesystem::absolute(database.file()).string(), spec.go_on);
}

void print_start(const RigSpec& spec,
                 const protocols::Plan& plan,
                 const data::OpenedSession& opened,
                 const protocols::Apparatus& apparatus) {
    const protocols::Protocol& protocol = spec.study.protocol;
    const protocols::PendingTrials all(plan);
    const std::size_t practice = all.left(true);
    const bool real = spec.kind == data::RunKind::real;
    say("{}: {}, participant {}, session {}, {}{}, {}, code {}\n", protocol.id,
        real ? "REAL" : to_string(spec.kind), spec.key.participant, spec.key.session,
        practice > 0 ? counted(practice, "practice trial") + " and " : std::string(),
        counted(all.left(false), "trial"), apparatus.device_name(), session_code(plan));
    if (spec.kind == data::RunKind::simulated) {
        say("Simulated: these data are recorded as simulated and never count as a person's.\n");
    }
    if (opened.resumed && !opened.finished) {
        say("Resuming at {}{}.\n", number_text(opened.progress.pending().number()),
            opened.interrupted > 0
                ? "; the trial that was cut off is kept as interrupted and run again"
                : "");
    }
}

/// Before anything is made: what stands against this device and this protocol.
/// @throws std::invalid_argument for what nobody should hold
void check_findings(const OpenedApparatus& felt) {
    for (const protocols::Finding& finding : felt.findings) {
        refuse_if(finding.verdict == protocols::Verdict::refuse, "{}", finding.text);
        warn("{}", finding.text);
    }
    for (const std::string& line : felt.refused) {
        warn("{}", line);
    }
}

std::string how_it_ended(const protocols::SessionEnd& end) {
    return end.why == protocols::SessionEnd::Why::finished ? "finished"
         : end.why == protocols::SessionEnd::Why::aborted  ? "ended early"
                                                           : "given up: " + end.fault;
}

void show_end(LiveSession& live,
              const protocols::OperatorDesk& desk,
              const protocols::SessionEnd& end) {
    live.end(how_it_ended(end));
    if (desk.force_doubted()) {
        warn("{}", engine::kForceUnproved);
    }
}

protocols::SessionView view_of(const RigSpec& spec,
                               const protocols::Plan& plan,
                               const data::OpenedSession& opened,
                               const protocols::Apparatus& apparatus) {
    const std::size_t next = opened.progress.pending().answered();
    return {.title = spec.study.protocol.title,
            .participant = spec.key.participant,
            .trials = plan.trials.size(),
            .next = next,
            .practice = opened.progress.pending().left(true),
            .breaks = std::ranges::any_of(plan.trials | std::views::drop(next + 1),
                                          &PlannedTrial::break_before),
            .simulated = spec.kind == data::RunKind::simulated,
            .device = apparatus.device_name()};
}

protocols::Ports ports_of(const RunningRig& rig,
                          std::vector<protocols::Event> opening,
                          protocols::Observer& observer,
                          protocols::Recorder& recorder,
                          OperatorLog& log) {
    return {.apparatus = rig.apparatus,
            .observer = observer,
            .recorder = recorder,
            .opening = std::move(opening),
            .interrupted =
                [rig] {
                    rig.live.pump();
                    return interrupted();
                },
            .happened =
                [rig](const protocols::Event& event) {
                    if (event.key == protocols::kRigCheck) {
                        rig.live.board().checked(event.value);
                    }
                },
            .felt =
                [rig](protocols::TrialId trial, const protocols::Presentation& felt) {
                    rig.live.board().began(trial);
                    rig.live.board().feels(felt);
                },
            .progress =
                [rig, &log](const protocols::Progress& progress) {
                    rig.live.board().over();
                    say("{}", log.line(progress, answer_line(rig.spec, progress), now_s()));
                    rig.live.board().attempted(progress, log.minutes(progress.left()),
                                               log.alarms());
                },
            .alarm =
                [](const protocols::TroubleView& view) {
                    say("{}", trouble_text(view));
                    ring();  // they may look elsewhere
                },
            .paused = [](bool begins) { say("{}", pause_text(begins)); },
            .marked =
                [rig, &log](const protocols::MarkReply& reply) {
                    say("{}", log.marked(reply));
                    rig.live.marked(reply, log.alarms());
                },
            .desk = &rig.desk};
}

/// `palpate console` beside a session, as a process of its own: whatever becomes of it, the session
/// goes on. It ends by itself after the session.
class ConsoleChild {
public:
    /// @param session  its uuid
    explicit ConsoleChild(std::string session) : session_(std::move(session)) { start(); }

    /// Starts it again, once, if it is gone. Waits for nothing.
    void look() {
        if (pid_ < 0 || waitpid(pid_, nullptr, WNOHANG) != pid_) {
            return;
        }
        pid_ = -1;
        if (std::exchange(again_, true)) {
            warn(
                "the experimenter's page ended again; palpate console {} starts it, from another "
                "terminal",
                session_);
        } else {
            warn("the experimenter's page ended, and is started again");
            start();
        }
    }

private:
    /// In a group of its own: Ctrl+C is for the session, which takes its time to end.
    void start() {
        std::array<const char*, 5> words{"palpate", "console", session_.c_str(), "--while-runs",
                                         nullptr};
        posix_spawnattr_t how;
        posix_spawnattr_init(&how);
        posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP);
        const int error = posix_spawn(&pid_, "/proc/self/exe", nullptr, &how,
                                      const_cast<char**>(words.data()), environ);
        posix_spawnattr_destroy(&how);
        if (error != 0) {
            pid_ = -1;
            warn(
                "the experimenter's page could not be started; palpate console {} does, from "
                "another terminal",
                session_);
        }
    }

    std::string session_;
    pid_t pid_ = -1;
    bool again_ = false;
};

void serve_page(const RigSpec& spec, LiveSession& live) {
    if (spec.console) {
        live.beside([page = ConsoleChild(live.board().facts().uuid)]() mutable { page.look(); });
    }
}

}  // namespace

OpenedApparatus open_and_check(const RigSpec& spec) {
    OpenedApparatus felt = open_apparatus(spec);
    check_findings(felt);
    return felt;
}

RigEnd run_rig(data::Database& database,
               const RigSpec& spec,
               std::optional<OpenedApparatus> opened_before) {
    const protocols::Protocol& protocol = spec.study.protocol;
    const OpenedApparatus felt = opened_before ? *std::move(opened_before) : open_and_check(spec);
    protocols::OperatorDesk desk;
    LiveSession live(desk);
    const RunningRig rig{spec, *felt.port, desk, live};
    Observers observers = observers_before_the_plan(rig);
    const OpenedMasking masking = open_masking(spec);
    data::SessionSpec session;
    const data::OpenedSession opened = begin_session(database, spec, felt, session);
    add_simulated_observer(observers, rig, session.plan);
    print_start(spec, session.plan, opened, *felt.port);
    if (opened.finished) {
        return {.session = {.next = session.plan.trials.size()}};
    }
    data::require_space(database.file(), protocol, opened.progress.pending().order().size());
    print_help(database, spec, observers.screen != nullptr);
    LiveFacts facts = live_facts(spec, felt, database, opened);
    facts.screen = observers.screen != nullptr;
    facts.masking_db = masking.player ? std::optional(protocol.masking.level_db) : std::nullopt;
    OperatorLog log(opened.progress.attempts(), now_s());
    const SummaryAtEnd summary(database, opened, spec);
    const std::size_t breaks = said_breaks(database, opened);
    data::SqliteRecorder recorder(database, protocol, opened.id);
    data::AsyncRecorder record(
        recorder, spec.durable ? data::AsyncRecorder::kSaveOften : data::AsyncRecorder::kSaveEvery);
    if (!masking.note.empty()) {
        record.event({.kind = protocols::EventKind::masking, .text = masking.note});
    }
    const auto masked = masking.player
                          ? std::make_unique<MaskedObserver>(observers.port(), *masking.player,
                                                             record, masking.required)
                          : nullptr;
    live.begin(std::move(facts), protocol, session.plan, record);
    LiveObserver shown(masked ? *masked : observers.port(), live);
    const auto lines = stop_lines(database, rig);
    serve_page(spec, live);
    protocols::SessionEnd end;
    try {
        end = run_session(protocol, session.plan, view_of(spec, session.plan, opened, *felt.port),
                          opened.progress, ports_of(rig, felt.opening, shown, record, log));
    } catch (const std::exception& e) {
        live.end(e.what());
        if (!observers.screen || observers.simulated) {
            throw;
        }
        keep_screen(*observers.screen, desk, e.what());
        throw std::runtime_error("the session ended there; what was recorded is kept");
    }
    show_end(live, desk, end);
    if (display_lost() && end.why == protocols::SessionEnd::Why::aborted) {
        record.event(
            {.kind = protocols::EventKind::display_lost, .text = "the session ended with it"});
    }
    return {std::move(end), data::kept_head(database, opened.id, breaks), breaks > 0};
}

bool finished(const protocols::SessionEnd& end) {
    using Why = protocols::SessionEnd::Why;
    const auto goes_on = [&](const std::string& why) {
        return fmt::format(
            "{}. The force is off and what was recorded is kept; {} goes on at {}", why,
            end.why == Why::faulted ? "the same command"
                                    : "where a display works again, the same command",
            number_text(end.number));
    };
    refuse_if<std::runtime_error>(
        end.why == Why::faulted, "{}",
        goes_on(fmt::format("gave up after {}: {}",
                            end.tries > 0
                                ? counted(end.tries, "try", "tries") + " to reach the device again"
                                : counted(end.in_a_row, "fault") + " in a row",
                            without_stop(end.fault))));
    refuse_if<std::runtime_error>(end.why == Why::aborted && display_lost(), "{}",
                                  goes_on("the display is gone"));
    return end.why == Why::finished;
}

}  // namespace palpate::ui
