#pragma once

#include "protocols/file/calibration_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/miswired_machine.hpp"
#include "tests/support/process.hpp"
#include "tests/support/test_text.hpp"

namespace palpate::tests {

/// Writes what `palpate commission` would of a right rig: a real session on an emulated board needs
/// it. Of a machine with the handle of `palpate haply-emulator --free`, commissioned on a virtual
/// clock.
/// @param device       the word for --device
/// @param calibration  a shipped machine's name or a file
/// @param board        id of an open board
/// @return the file, for --calibration
inline std::string commissioned_rig(const TemporaryFolder& folder,
                                    const std::string& device,
                                    const std::string& calibration = "2diy_gen3",
                                    std::uint32_t board = 0) {
    engine::Calibration machine = protocols::load_calibration(calibration);
    engine::PlantModel plant;
    plant.machine = machine.pantograph;
    const engine::Pantograph pantograph(machine.pantograph);
    const engine::Vec2 home =
        machine.home.value_or(pantograph.locate(pantograph.angles({0, 0}))->hip);
    MiswiredMachine right(plant, {}, {});
    engine::CommissioningResult done = engine::commission(
        right, machine, engine::places_to_commission(machine, home),
        engine::Vec3(plant.handle_mass),
        attended([&](const engine::Vec3& place) { right.bring(engine::Vec2(place)); }, [] {}));
    if (!done.refused.empty()) {
        throw std::runtime_error(done.refused);
    }
    machine.pantograph.damping = done.record.damping;
    done.record.device = device;
    if (device.starts_with("board:")) {
        done.record.board = board;
    }
    done.record.calibration = protocols::calibration_id(machine);
    done.record.program = PALPATE_VERSION;
    std::ofstream(folder.file("rig.toml")) << protocols::to_toml(machine, done.record);
    return folder.file("rig.toml");
}

/// A program that somebody types to.
class TypedTo {
public:
    TypedTo(const TemporaryFolder& folder,
            const std::string& name,
            const std::string& words,
            const Words& environment = {},
            const std::string& program = palpate_program())
        : pipe_(folder.file(name)) {
        std::string command =
            "mkfifo '" + pipe_ + "' && exec '" + program + "' " + words + " <> '" + pipe_ + "'";
        program_ = std::make_unique<Process>(Words{"sh", "-c", command}, environment);
    }
    /// Opens the way to it when first used: waits until the program reads.
    void type(const std::string& line) {
        if (!keys_.is_open()) {
            while (!std::filesystem::exists(pipe_)) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            keys_.open(pipe_);
        }
        keys_ << line << '\n' << std::flush;
    }
    /// Waits until it has printed `text`, or ended. @return it runs on
    [[nodiscard]] bool says(std::string_view text) {
        static_cast<void>(eventually([&] {
            return program_->out().find(text) != std::string::npos || !program_->running();
        }));
        return program_->running();
    }
    /// Says nothing more.
    void end() { keys_.close(); }
    [[nodiscard]] Process& program() { return *program_; }

private:
    std::string pipe_;
    std::ofstream keys_;
    std::unique_ptr<Process> program_;
};

inline std::string study_of_rig(const TemporaryFolder& folder) {
    // Soft: its handle stays at home.
    return write(folder.file("p.toml"),
                 edited(four_trials(),
                        {{"stiffness_n_per_m = 1000\nforce_limit_n = 10",
                          "start_radius_mm = 0\nstiffness_n_per_m = 200\nforce_limit_n = 1.5"},
                         {"break_every = 0", "break_every = 1"}}));
}

inline std::string ran_words(const TemporaryFolder& folder, const std::string& device) {
    return "run '" + study_of_rig(folder) + "' --participant P1 --db '" + folder.file("d.sqlite") +
           "' --windowed --device " + device;
}

}  // namespace palpate::tests
