#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocols/observer/person.hpp"
#include "protocols/protocol/observer_model.hpp"
#include "protocols/session/session.hpp"
#include "data/store/database.hpp"
#include "ui/session/load_study.hpp"

namespace palpate::protocols {
class SimulatedObserver;
}

/// Simulated participants: the way of a session of `palpate run` on the simulated pantograph, but
/// for a clock that waits for nobody and files that nobody sees.
namespace palpate::ui {

/// What all simulated participants of a study share.
struct SimulatedStudy {
    Study study;
    std::uint64_t seed = 0;
    std::string secret;  ///< what orders, hands and answers are drawn with, 32 hexadecimal digits
    std::optional<protocols::ObserverModel>
        observer{};      ///< none: [observer] of the protocol, all alike
    bool traces = true;  ///< ticks are kept
};

/// "S000001", ...: by the number alone, whoever else is simulated. @param index  from 0
[[nodiscard]] std::string simulated_code(std::size_t index);

/// A participant's session: everything follows from study, seed, secret and index.
class SimulatedSession {
public:
    /// @throws as open_apparatus(); protocols::OrderError
    SimulatedSession(const SimulatedStudy& of, std::size_t index);

    [[nodiscard]] const protocols::Plan& plan() const noexcept { return plan_; }
    /// What is to be known of device and protocol together (OpenedApparatus::findings).
    [[nodiscard]] const std::vector<std::string>& findings() const noexcept { return findings_; }

    /// Runs it to its end and keeps it in a database in memory. Its rows say that it began at
    /// midnight of 1 January 2000, UTC, and lasted as long as a person would have taken. Its uuid
    /// follows from what it is.
    /// @param provenance  of the program, as provenance(protocol)
    /// @return nothing: interrupted(). @throws std::runtime_error if the force went off and nobody
    /// mended it
    [[nodiscard]] std::unique_ptr<data::Database> run(
        const std::vector<std::pair<std::string, std::string>>& provenance);

    /// Runs it to its end and keeps nothing. @return what every trial that counts lets one feel
    /// @throws std::runtime_error if it was interrupted or a force went off
    [[nodiscard]] std::vector<protocols::FeltTrial> feel();

private:
    /// @param heard  of each attempt
    [[nodiscard]] protocols::SessionEnd run(
        protocols::Recorder& recorder,
        protocols::SessionProgress progress,
        std::function<void(const protocols::Progress&)> heard = [](const protocols::Progress&) {});

    const SimulatedStudy& of_;
    protocols::SessionKey key_;
    protocols::Plan plan_{};
    std::unique_ptr<protocols::Apparatus> apparatus_;
    std::shared_ptr<protocols::SimulatedObserver> answers_;
    std::vector<std::string> findings_;
    std::vector<std::pair<std::string, std::string>> opened_;  ///< provenance of the apparatus
};

/// What hands of simulated people feel in the main trials of a study: of each whole session,
/// without practice, catch trials and breaks, every trial that counts. Nothing is recorded. In the
/// order of people and trials, whatever the number of threads.
/// @throws as SimulatedSession; std::runtime_error if it was interrupted or a force went off
[[nodiscard]] std::vector<protocols::FeltTrial> felt_hands(const SimulatedStudy& study,
                                                           std::size_t people,
                                                           std::size_t threads);

}  // namespace palpate::ui
