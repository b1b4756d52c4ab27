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
#include "protocols/observer/simulated_observer.hpp"
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
    : of_(of), key_{simulated_code(index), 1, of.secret}, plan_(plan_of(of, key_, index)) {
    const protocols::StreamKey stream = session_stream(of.study.hash, key_, of.seed);
    const protocols::Person person = of.observer
                                       ? drawn_person(*of.observer, stream)
                                       : protocols::Person{.spec = of.study.protocol.observer};
    RigSpec rig;
    rig.rig = rig_file_of(rig.device, "");
    rig.study = of.study;
    rig.key = key_;
    rig.seed = of.seed;
    rig.hand = person.hand;
    rig.screen.headless = true;
    OpenedApparatus opened = open_apparatus(rig);
    for (const protocols::Finding& finding : opened.findings) {
        refuse_if(finding.verdict == protocols::Verdict::refuse, "{}", finding.text);
        findings_.push_back(finding.text);
    }
    apparatus_ = std::move(opened.port);
    opened_ = std::move(opened.provenance);
    answers_ = std::make_shared<protocols::SimulatedObserver>(
        of.study.protocol, stream, plan_.picture_order,
        [port = apparatus_.get()] { return port->hand_is_done(); }, person);
}

protocols::SessionEnd SimulatedSession::run(protocols::Recorder& recorder,
                                            protocols::SessionProgress progress,
                                            std::function<void(const protocols::Progress&)> heard) {
    const protocols::SessionView view{.title = of_.study.protocol.title,
                                      .participant = key_.participant,
                                      .trials = plan_.trials.size(),
                                      .practice = progress.pending().left(true),
                                      .simulated = true,
                                      .device = apparatus_->device_name()};
    return run_session(of_.study.protocol, plan_, view, std::move(progress),
                       {.apparatus = *apparatus_,
                        .observer = *answers_,
                        .recorder = recorder,
                        .interrupted = interrupted,
                        .progress = std::move(heard)});
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
    database->set_clock([this] { return kMidnight + std::llround(1e9 * answers_->time_s()); });
    const data::OpenedSession opened = data::open_session(*database, spec);
    data::SqliteRecorder recorder(*database, protocol, opened.id, of_.traces);
    const protocols::SessionEnd end = run(recorder, opened.progress);
    database->set_clock({});
    refuse_if<std::runtime_error>(end.why == protocols::SessionEnd::Why::faulted, "{}: {}",
                                  key_.participant, end.fault);
    return end.why == protocols::SessionEnd::Why::finished ? std::move(database) : nullptr;
}

std::vector<protocols::FeltTrial> SimulatedSession::feel() {
    std::vector<protocols::FeltTrial> felt;
    protocols::Recorder nothing;
    const protocols::SessionEnd end =
        run(nothing,
            protocols::SessionProgress(of_.study.protocol, plan_,
                                       session_stream(of_.study.hash, key_, of_.seed)),
            [&](const protocols::Progress& progress) {
                if (progress.result.response && progress.result.invalid.empty()) {
                    felt.push_back({.object = progress.planned.condition.object,
                                    .friction = progress.planned.condition.friction,
                                    .cues = answers_->felt()});
                }
            });
    refuse_if<std::runtime_error>(end.why != protocols::SessionEnd::Why::finished, "{}",
                                  end.why == protocols::SessionEnd::Why::aborted
                                      ? std::string("it was interrupted: nothing was computed")
                                      : end.fault);
    return felt;
}

std::vector<protocols::FeltTrial> felt_hands(const SimulatedStudy& all,
                                             std::size_t people,
                                             std::size_t threads) {
    SimulatedStudy study = all;
    protocols::DesignSpec& design = study.study.protocol.design;
    design.practice_repetitions = 0;
    design.catch_trials = 0;
    design.break_every = 0;
    study.study.protocol.timing.answer_timeout = 0.0;  // what they answer is nothing here
    std::vector<std::vector<protocols::FeltTrial>> felt(people);
    for_each_number(threads, people,
                    [&](std::size_t i) { felt[i] = SimulatedSession(study, i).feel(); });
    std::vector<protocols::FeltTrial> together;
    for (const auto& one : felt) {
        together.insert(together.end(), one.begin(), one.end());
    }
    return together;
}

}  // namespace palpate::ui
