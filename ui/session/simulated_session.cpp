#include "ui/session/simulated_session.hpp"

#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/side_by_side.hpp"
#include "protocols/design/counterbalance.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/observer_file.hpp"
#include "protocols/session/session.hpp"
#include "data/store/secret.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/store/uuid.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/session/open_apparatus.hpp"
#include "ui/session/provenance.hpp"

namespace palpate::ui {
namespace {

constexpr std::int64_t kMidnight = 946'684'800'000'000'000;  ///< 1 January 2000, ns since 1970

/// The row of a participant: sets of all rows one after the other, each in an order of its own, so
/// that of any first n participants no row has two more than another, and nobody has to know who
/// else was simulated.
protocols::RowHistory dealt_row(const SimulatedStudy& of,
                                std::size_t index,
                                std::size_t rows,
                                std::string_view purpose) {
    Pcg32 random = protocols::stream({.protocol_hash = of.study.hash,
                                      .participant = {},
                                      .session = 0,
                                      .block = index / rows,
                                      .purpose = std::string(purpose),
                                      .seed = of.seed,
                                      .secret = of.secret});
    std::vector<std::size_t> order(rows);
    std::iota(order.begin(), order.end(), std::size_t{0});
    shuffle(std::span(order), random);
    return {.uses = {}, .own = order[index % rows]};
}

protocols::Plan plan_of(const SimulatedStudy& of,
                        const protocols::SessionKey& key,
                        std::size_t index) {
    const protocols::Protocol& protocol = of.study.protocol;
    const auto pictures =
        dealt_row(of, index, protocols::picture_rows(protocol).size(), protocols::purpose::rows);
    const auto frictions = dealt_row(of, index, protocols::friction_rows(protocol).size(),
                                     protocols::purpose::friction_rows);
    return make_plan(protocol, of.study.hash, key, of.seed, pictures, frictions);
}

/// What the session is, but for its answers, which follow.
std::string content_of(const SimulatedStudy& of,
                       const protocols::SessionKey& key,
                       const std::string& observer) {
    return fmt::format(
        "palpate-simulated-v1\nprotocol={}\nparticipant={}\nsession={}\nseed={}\nsecret={}\n"
        "traces={}\nbuild={}\nobserver={}:{}\n",
        of.study.hash, key.participant, key.session, of.seed, key.secret, of.traces ? 1 : 0,
        build_id(), observer.size(), observer);
}

}  // namespace

std::string simulated_code(std::size_t index) {
    return fmt::format("S{:06}", index + 1);
}

SimulatedSession::SimulatedSession(const SimulatedStudy& of, std::size_t index)
    : of_(of), key_{simulated_code(index), 1, of.secret} {
    const protocols::StreamKey stream = session_stream(of.study.hash, key_, of.seed);
    person_ = of.observer ? drawn_person(*of.observer, stream)
                          : protocols::Person{.spec = of.study.protocol.observer};
    plan_ = plan_of(of, key_, index);
    RigSpec rig;
    rig.rig = rig_file_of(rig.device, "");
    rig.study = of.study;
    rig.key = key_;
    rig.seed = of.seed;
    rig.hand = person_.hand;
    rig.screen.headless = true;
    OpenedApparatus opened = open_apparatus(rig);
    for (const protocols::Finding& finding : opened.findings) {
        refuse_if(finding.verdict == protocols::Verdict::refuse, "{}", finding.text);
        findings_.push_back(finding.text);
    }
    apparatus_ = std::move(opened.port);
    opened_ = std::move(opened.provenance);
}

std::unique_ptr<data::Database> SimulatedSession::run(
    const std::vector<std::pair<std::string, std::string>>& provenance) {
    const protocols::Protocol& protocol = of_.study.protocol;
    const std::string observer = of_.observer ? observer_text(*of_.observer) : std::string();
    auto database = std::make_unique<data::Database>(key_.participant, data::Access::memory);
    set_secret(*database, key_.secret);
    data::SessionSpec spec{.protocol = protocol,
                           .protocol_hash = of_.study.hash,
                           .plan = plan_,
                           .key = key_,
                           .seed = of_.seed,
                           .kind = data::RunKind::simulated,
                           .device = apparatus_->device_name(),
                           .provenance = provenance,
                           .uuid = data::content_uuid(content_of(of_, key_, observer))};
    spec.provenance.insert(spec.provenance.end(), opened_.begin(), opened_.end());
    if (of_.observer) {
        spec.provenance.emplace_back(data::kObserverKey, observer);
    }
    if (!of_.traces) {
        spec.provenance.emplace_back(data::kTracesKey, data::kNoTraces);
    }
    protocols::SimulatedObserver answers(
        protocol, session_stream(of_.study.hash, key_, of_.seed), plan_.picture_order,
        [this] { return apparatus_->hand_is_done(); }, person_);
    database->set_clock([&answers] { return kMidnight + std::llround(1e9 * answers.time_s()); });
    const data::OpenedSession opened = data::open_session(*database, spec);
    data::SqliteRecorder recorder(*database, protocol, opened.id, of_.traces);
    const protocols::SessionEnd end = run_session(
        protocol, plan_,
        {.title = protocol.title,
         .participant = key_.participant,
         .trials = plan_.trials.size(),
         .practice = opened.progress.pending().left(true),
         .simulated = true,
         .device = apparatus_->device_name()},
        opened.progress,
        {.apparatus = *apparatus_, .observer = answers, .recorder = recorder, .interrupted = [] {
             return interrupted();
         }});
    database->set_clock({});
    switch (end.why) {
        case protocols::SessionEnd::Why::finished:
            return database;
        case protocols::SessionEnd::Why::aborted:
            return nullptr;
        case protocols::SessionEnd::Why::faulted:
            break;
    }
    throw std::runtime_error(fmt::format("{}: {}", key_.participant, end.fault));
}

namespace {

using namespace protocols;

/// Feels as long as its hand does, and answers anything.
class FeelingOnly : public Observer {
public:
    FeelingOnly(const OutlineSpec& outline, Apparatus& apparatus)
        : outline_(outline), apparatus_(apparatus), cues_(outline) {}

    [[nodiscard]] Signal welcome(const SessionView& /*session*/) override { return Signal::go_on; }
    [[nodiscard]] Signal ready(const TrialView& /*trial*/) override {
        cues_ = CurvatureCues(outline_);
        return Signal::go_on;
    }
    [[nodiscard]] ExplorationStep explore(const TrialView& trial, double elapsed_s) override {
        const bool done = elapsed_s >= trial.explore_min_s && apparatus_.hand_is_done();
        return {.signal = done ? Signal::done : Signal::go_on, .at_s = elapsed_s};
    }
    void feel(std::span<const engine::TickRecord> ticks) override { cues_.add(ticks); }
    [[nodiscard]] Choice choose(const TrialView& /*trial*/, const Question& question) override {
        Choice choice;
        choice.confidence = question.confidence ? std::optional(1) : std::nullopt;
        return choice;
    }
    [[nodiscard]] Signal gap(double /*seconds*/) override { return Signal::go_on; }
    [[nodiscard]] Signal rest(double /*seconds*/, const TrialView& /*next*/) override {
        return Signal::go_on;
    }
    void finish(const SessionView& /*session*/) override {}

    [[nodiscard]] Cues cues() const noexcept { return cues_.cues(); }

private:
    OutlineSpec outline_;
    Apparatus& apparatus_;
    CurvatureCues cues_;
};

class NoRecorder : public Recorder {
public:
    [[nodiscard]] TrialId begin_trial(const PlannedTrial& /*planned*/) override {
        return ++trials_;
    }
    void begin_interval(TrialId /*trial*/,
                        const Presentation& /*felt*/,
                        const SceneConstants& /*scene*/) override {}
    void append(TrialId /*trial*/, std::span<const engine::TickRecord> /*ticks*/) override {}
    void end_trial(TrialId /*trial*/, const TrialResult& /*result*/) override {}
    void event(const Event& /*event*/) override {}
    void finish_session() override {}

private:
    TrialId trials_ = 0;
};

std::vector<FeltTrial> felt_by(const SimulatedStudy& study, std::size_t index) {
    const Protocol& protocol = study.study.protocol;
    SimulatedSession session(study, index);
    FeelingOnly observer(protocol.outline, session.apparatus());
    NoRecorder recorder;
    std::vector<FeltTrial> felt;
    SessionView view;
    view.simulated = true;
    const SessionEnd end =
        run_session(protocol, session.plan(), view,
                    SessionProgress(protocol, session.plan(),
                                    session_stream(study.study.hash, session.key(), study.seed)),
                    {.apparatus = session.apparatus(),
                     .observer = observer,
                     .recorder = recorder,
                     .interrupted = [] { return interrupted(); },
                     .progress =
                         [&](const Progress& progress) {
                             if (progress.result.response && progress.result.invalid.empty()) {
                                 felt.push_back({.object = progress.planned.condition.object,
                                                 .friction = progress.planned.condition.friction,
                                                 .cues = observer.cues()});
                             }
                         }});
    refuse_if<std::runtime_error>(end.why != SessionEnd::Why::finished, "{}",
                                  end.why == SessionEnd::Why::aborted
                                      ? std::string("it was interrupted: nothing was computed")
                                      : end.fault);
    return felt;
}

}  // namespace

std::vector<FeltTrial> felt_hands(const SimulatedStudy& all,
                                  std::size_t people,
                                  std::size_t threads) {
    SimulatedStudy study = all;
    DesignSpec& design = study.study.protocol.design;
    design.practice_repetitions = 0;
    design.catch_trials = 0;
    design.break_every = 0;
    std::vector<std::vector<FeltTrial>> felt(people);
    for_each_number(threads, people, [&](std::size_t i) { felt[i] = felt_by(study, i); });
    std::vector<FeltTrial> together;
    for (const auto& one : felt) {
        together.insert(together.end(), one.begin(), one.end());
    }
    return together;
}

}  // namespace palpate::ui
