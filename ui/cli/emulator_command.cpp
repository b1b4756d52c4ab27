#include <array>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/commissioning/place_proof.hpp"
#include "engine/device/emulator/emulated_board.hpp"
#include "engine/device/emulator/hands.hpp"
#include "engine/device/emulator/haply_board.hpp"
#include "engine/device/emulator/open_board.hpp"
#include "engine/device/emulator/served_board.hpp"
#include "protocols/file/calibration_file.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/open_device.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {
namespace {

struct EmulatorOptions {
    std::string link;                  ///< a symbolic link to the terminal; empty: none
    std::string preset = "2diy_gen3";  ///< a calibration file, or the name of a shipped machine
    double delay_ms = 0.0;             ///< from a packet to its answer
    bool open = false;                 ///< an open board instead
    std::optional<std::int64_t> udp;   ///< its UDP port instead of a terminal; 0: any
    bool free = false;                 ///< nobody holds the handle
    std::string at;                    ///< where it rests then; empty: at home
    std::string start;                 ///< where a hand that explores rests; empty: 0,60
    double handle_g = 60.0;            ///< of a linkage, as the two below
    double handle_damping = 0.0;
    double handle_friction = 0.0;
    bool of_linkage = false;  ///< --start or one of these is said
};

constexpr int kStepUs = 250;
constexpr int kDelayStepUs = 50;  ///< a delayed answer goes out at the end of a step

void declare_free_handle(CommandWords& words, EmulatorOptions& options) {
    words.add("--free", options.free,
              "Nobody holds the handle, and motors move it; a line X_MM,Y_MM on standard input "
              "brings it there (X_MM,Y_MM,Z_MM on a machine of three axes), gain G lets motors "
              "give G times what they are asked for, motor N G does so of one; hold, explore and "
              "let go bring a hand to it, still or on its way, and take it away. On three axes "
              "swap N M lets two motors change places, friction N and weight N burden the handle");
    words
        .add("--at", options.at,
             "Where a free handle rests at first, X_MM,Y_MM or X_MM,Y_MM,Z_MM; left out: at home")
        .needs("--free");
    words
        .add("--start", options.start,
             "Where a hand that explores rests, X_MM,Y_MM: start_mm. Left out: 0,60")
        .needs("--free")
        .tells(options.of_linkage);
    const auto of_linkage = [&](const char* word, double& value, double lowest, double highest,
                                const char* text) {
        words.add(word, value, text)
            .within(lowest, highest)
            .with_default()
            .needs("--free")
            .tells(options.of_linkage);
    };
    of_linkage("--handle-g", options.handle_g, 1.0, 2000.0,
               "What a free handle weighs with the near halves of its links");
    of_linkage("--handle-damping", options.handle_damping, 0.0, 100.0,
               "What brakes it at the handle itself, N s/m: a plate, a sleeve, air");
    of_linkage("--handle-friction", options.handle_friction, 0.0, 10.0,
               "Its dry friction at the handle itself, N");
}

void declare(CommandWords& words, EmulatorOptions& options) {
    words.add("--link", options.link,
              "A link to its terminal, for --device haply:LINK or board:LINK");
    words.add(
        "--preset", options.preset,
        "2diy_gen3, 2diy_gen2, haplet, or a calibration file, with --open also of three axes");
    words
        .add("--delay-ms", options.delay_ms,
             "How long after a packet its answer goes out, ms; a USB port needs about 1. A line "
             "delay MS on standard input changes it")
        .within(0.0, 1000.0)
        .with_default();
    words.add("--open", options.open,
              "An open board's firmware instead of a Haply board, for --device board:LINK. A line "
              "motors on standard input prints what the motors give, unplug N pulls the cable of "
              "encoder N, plug N puts it in again; on a Haply board misread makes it take the next "
              "packet for a reset, with stranger N another program sends it N torques, turned N "
              "turns its last encoder by N degrees (a slip if N is a multiple of 360 / "
              "counts_per_turn, else an angle that no encoder has), and old N makes its answers N "
              "answers old");
    words
        .add("--udp", options.udp,
             "The open board behind this UDP port of this machine, 0 for any that is free; what it "
             "prints stands behind --device board:")
        .within(0, 65535)
        .needs("--open")
        .excludes("--link");
    declare_free_handle(words, options);
}

/// Lines of standard input that are there, without waiting for one.
class InputLines {
public:
    [[nodiscard]] std::vector<std::string> take() {
        pollfd input{.fd = open_ ? STDIN_FILENO : -1, .events = POLLIN, .revents = 0};
        std::array<char, 256> bytes{};
        // In the background a read would stop it: what is typed is for another program.
        if (poll(&input, 1, 0) > 0 &&
            (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) == getpgrp())) {
            const ssize_t got = read(STDIN_FILENO, bytes.data(), bytes.size());
            open_ = got > 0;
            kept_.append(bytes.data(), open_ ? static_cast<std::size_t>(got) : 0);
        }
        std::vector<std::string> lines;
        for (std::size_t end = kept_.find('\n'); end != std::string::npos; end = kept_.find('\n')) {
            lines.push_back(kept_.substr(0, end));
            kept_.erase(0, end + 1);
        }
        return lines;
    }

private:
    std::string kept_;
    bool open_ = true;
};

using Obey = std::function<bool(const std::string&)>;  ///< a line; false: it is of something else
using Look = std::function<void()>;                    ///< after a step

/// "gain 2". @return none: another line @throws std::invalid_argument outside of the range
std::optional<double> number_after(const std::string& line,
                                   std::string_view word,
                                   double least,
                                   double max) {
    if (!line.starts_with(word)) {
        return std::nullopt;
    }
    const auto number = parsed<double>(std::string_view(line).substr(word.size()));
    refuse_if(!number || !(*number >= least && *number <= max),
              "{}: give a number from {:g} to {:g}, as in {}2", line, least, max, word);
    return number;
}

/// A board behind its port lives until somebody interrupts it.
template <class Port, class Board>
void serve(Port& port, Board& board, const Obey& obey, const Look& look, double delay) {
    catch_signals();
    engine::run_like_a_board();
    say("{}\n", port.path());
    board.delay_answers(delay);
    InputLines lines;
    while (!interrupted()) {
        port.step(delay > 0.0 ? kDelayStepUs : kStepUs);
        look();
        for (const std::string& line : lines.take()) {
            try {
                if (const auto ms = number_after(line, "delay ", 0.0, 1000.0)) {
                    delay = 1e-3 * *ms;
                    board.delay_answers(delay);
                    say("Answers take {:g} ms\n", *ms);
                } else if (!obey(line)) {
                    warn("{}: nothing here takes this; delay 2 makes answers take 2 ms", line);
                }
            } catch (const std::exception& e) {
                warn("{}", e.what());
            }
        }
    }
}

/// Lines about what befalls a Haply board's wire. @return false: it is another line
bool obey_wire(engine::HaplyBoard& board, const std::string& line) {
    if (line == "motors") {
        say("{} of {} resets came with a torque on; the motors give {:g}, {:g} mN m\n",
            board.journal().hot_resets, board.journal().resets, 1e3 * board.torque().x,
            1e3 * board.torque().y);
    } else if (line == "misread") {
        board.misread_next();
        say("The next packet arrives as a reset\n");
    } else if (const auto degrees = number_after(line, "turned ", -90.0, 90.0)) {
        board.turn_answers(*degrees);
        say("The last encoder says {:g} degrees more\n", *degrees);
    } else if (const auto before = number_after(line, "old ", 0.0, 1000.0)) {
        board.age_answers(static_cast<std::size_t>(*before));
        say("Answers say where the handle was {:g} answers before\n", *before);
    } else if (const auto packets = number_after(line, "stranger ", 1.0, 1e6)) {
        board.meddle(static_cast<int>(*packets));
        say("Another program sends {:g} packets of 0.1 N m\n", *packets);
    } else {
        return false;
    }
    return true;
}

/// Lines about motors and encoders. @return false: it is another line
bool obey_cables(engine::OpenBoard& board, const std::string& line, double axes) {
    if (line == "motors") {
        say("The motors give {:g}, {:g}{} mN m\n", 1e3 * board.torque().x, 1e3 * board.torque().y,
            axes > 2 ? fmt::format(", {:g}", 1e3 * board.torque().z) : std::string());
        return true;
    }
    const auto out = number_after(line, "unplug ", 1.0, axes);
    const auto in = number_after(line, "plug ", 1.0, axes);
    if (out || in) {
        const auto axis = static_cast<std::size_t>(out.value_or(in.value_or(1.0)));
        board.unplug_encoder(axis - 1, out.has_value());
        say("Encoder {} is {}\n", axis, out ? "unplugged" : "plugged in");
    }
    return out || in;
}

/// The board with whatever hangs on it.
void live(
    const EmulatorOptions& options,
    const engine::Calibration& machine,
    engine::BoardPlant& plant,
    const Obey& obey,
    const Look& look = [] {}) {
    const double delay = 1e-3 * options.delay_ms;
    if (!options.open) {
        engine::HaplyBoard board(plant, machine.pantograph, *machine.haply);
        engine::PtyBoard terminal(board, options.link);
        return serve(
            terminal, board,
            [&](const std::string& line) { return obey_wire(board, line) || obey(line); }, look,
            delay);
    }
    engine::OpenBoard board(plant, machine, *machine.board);
    const Obey obey_board = [&](const std::string& line) {
        return obey_cables(board, line, static_cast<double>(machine.axes())) || obey(line);
    };
    if (options.udp) {
        engine::UdpBoard port(board, static_cast<std::uint16_t>(*options.udp));
        return serve(port, board, obey_board, look, delay);
    }
    engine::PtyBoard terminal(board, options.link);
    serve(terminal, board, obey_board, look, delay);
}

/// "motor 2 -1", "swap 1 2": a motor, and another or a number. @return none: it is another line
std::optional<std::pair<std::size_t, double>> motor_and(const std::string& line,
                                                        const std::string& word,
                                                        double axes) {
    const std::size_t gap = line.find(' ', word.size());
    const auto motor = number_after(line.substr(0, gap), word, 1.0, axes);
    if (!motor || gap == std::string::npos) {
        return std::nullopt;
    }
    const auto number = number_after(line.substr(gap), " ", -100.0, 100.0);
    return std::pair(static_cast<std::size_t>(*motor) - 1, number.value_or(0.0));
}

/// Lines about motors and hand that every free handle takes. @return false: it is another line
template <class Handle>
bool obey_handle(Handle& handle, const std::string& line, double axes) {
    if (const auto gain = number_after(line, "gain ", -100.0, 100.0)) {
        handle.gain() = std::remove_reference_t<decltype(handle.gain())>(*gain);
        say("The motors give {:g} times what they are asked for\n", *gain);
    } else if (const auto one = motor_and(line, "motor ", axes)) {
        handle.gain()[static_cast<int>(one->first)] = one->second;
        say("Motor {} gives {:g} times what it is asked for\n", one->first + 1, one->second);
    } else if (line == "hold" || line == "let go") {
        handle.hold(line == "hold");
        say("{} the handle\n", line == "hold" ? "A hand holds" : "Nobody holds");
    } else {
        return false;
    }
    return true;
}

/// Lines about a free handle on a linkage. @return false: it is another line
bool obey_linkage(engine::FreeHandle& handle,
                  const std::string& line,
                  const engine::Exploration& plan) {
    if (line == "explore") {
        handle.explore(plan);
        say("A hand rests {:g} s at ({:g}, {:g}) mm, explores, and so on\n",
            engine::FreeHandle::kRest, 1e3 * plan.start.x, 1e3 * plan.start.y);
        return true;
    }
    return obey_handle(handle, line, 2.0);
}

/// Lines about what is wrong with a free handle on three axes. @return false: it is another line
bool obey_gantry(engine::GantryHand& hand, const std::string& line) {
    if (const auto two = motor_and(line, "swap ", 3.0)) {
        hand.swap_motors(two->first,
                         static_cast<std::size_t>(std::clamp(two->second, 1.0, 3.0)) - 1);
        say("Motors {} and {:g} have changed places\n", two->first + 1, two->second);
    } else if (const auto friction = number_after(line, "friction ", 0.0, 100.0)) {
        hand.burden(*friction, hand.model().weight);
        say("Each axis rubs by {:g} N\n", *friction);
    } else if (const auto weight = number_after(line, "weight ", -100.0, 100.0)) {
        hand.burden(hand.model().friction, *weight);
        say("The handle weighs {:g} N more than its counterweight\n", *weight);
    } else if (line == "explore") {
        hand.explore();
        say("A hand explores with the handle, from home\n");
    } else {
        return obey_handle(hand, line, 3.0);
    }
    return true;
}

template <std::size_t kAxes, class Handle>
void live_brought(const EmulatorOptions& options,
                  const engine::Calibration& machine,
                  Handle& handle,
                  const Obey& obey) {
    std::string coming;
    const Obey bring = [&](const std::string& line) {
        if (!obey(line)) {
            handle.bring(parse_place<kAxes>(line, "brought to"));
            coming = line;
        } else if (!handle.on_its_way()) {
            coming.clear();  // held on its way
        }
        return true;
    };
    live(options, machine, handle, bring, [&] {
        if (!coming.empty() && !handle.on_its_way()) {
            say("The handle is at {} mm\n", std::exchange(coming, {}));
        }
    });
}

/// A machine of three straight axes, held or free.
void live_in_space(const EmulatorOptions& options, const engine::Calibration& machine) {
    refuse_if(options.of_linkage,
              "--start, --handle-g, --handle-damping and --handle-friction are of a linkage, and "
              "{} has three axes: type friction N and weight N to it",
              machine.name());
    engine::GantryHand hand(machine, !options.free);
    if (!options.at.empty()) {
        hand.bring(parse_place<3>(options.at, "--at"));
    }
    if (options.free) {
        live_brought<3>(options, machine, hand,
                        [&](const std::string& line) { return obey_gantry(hand, line); });
    } else {
        live(options, machine, hand, [](const std::string&) { return false; });
    }
}

void live_free(const EmulatorOptions& options, const engine::Calibration& machine) {
    engine::PlantModel plant;
    plant.machine = machine.pantograph;
    plant.handle_mass = 1e-3 * options.handle_g;
    plant.handle_damping = options.handle_damping;
    plant.handle_friction = options.handle_friction;
    engine::Exploration plan;
    plan.start = options.start.empty() ? plan.start : parse_place(options.start, "--start");
    refuse_if(!options.start.empty() && !engine::Pantograph(machine.pantograph).reach(plan.start),
              "--start {}: the handle of {} does not reach there", options.start, machine.name());
    engine::FreeHandle handle(plant, options.at.empty() ? engine::Vec2(engine::home_of(machine))
                                                        : parse_place(options.at, "--at"));
    live_brought<2>(options, machine, handle,
                    [&](const std::string& line) { return obey_linkage(handle, line, plan); });
}

int run(const EmulatorOptions& options) {
    const engine::Calibration machine = protocols::load_calibration(options.preset);
    refuse_if(options.open ? !machine.board : !machine.haply, "--preset {}: this machine has no {}",
              options.preset,
              options.open ? "open board; give 2diy_gen3 or a file with [pantograph.board]"
                           : "Haply board; give 2diy_gen3, 2diy_gen2 or haplet");
    require_free(options.link);
    if (machine.gantry) {
        live_in_space(options, machine);
    } else if (options.free) {
        live_free(options, machine);
    } else {
        engine::DeskHand hand(machine);
        live(options, machine, hand, [](const std::string&) { return false; });
    }
    return 0;
}

}  // namespace

Command emulator_command() {
    return make_command<EmulatorOptions>("haply-emulator",
                                         "A Haply or an open board that is not there, on a "
                                         "pseudo-terminal or a UDP port, until Ctrl-C",
                                         declare, run);
}

}  // namespace palpate::ui
