#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocols/order/constrained_order.hpp"
#include "data/csv/number_table.hpp"
#include "data/sql/statement.hpp"
#include "ui/cli/scene_tools.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/say.hpp"

namespace palpate::ui {

// Every command, each in its file, in the order of --help: declared here, listed below.
Command demo_command(), new_command(), check_command(), run_command(), stop_command(),
    status_command(), console_command(), preview_command(), simulate_command(), power_command(),
    sequence_command(), summary_command(), fit_command(), stats_command(), audit_command(),
    report_command(), analysis_command(), participant_command(), note_command(), mark_command(),
    session_command(), verify_command(), sql_command(), extension_command(), trace_command(),
    export_command(), merge_command(), push_command(), calibrate_command(), commission_command(),
    doctor_command(), emulator_command(), closest_command(), deform_command(), figures_command(),
    procedure_command(), screenshots_command();
Command render_command(MakePlaneFeel thesis);
Command words_command(std::vector<Command> (*all)());

}  // namespace palpate::ui

namespace palpate::figures {

/// The thesis' own renderer, in tests/figures/thesis: no room knows it, and scenes may name it.
ui::PlaneFeel thesis_feel(const protocols::SceneFile& scene, double period);

}  // namespace palpate::figures

namespace {

using namespace palpate::ui;

std::vector<Command> all_commands() {
    return {
        demo_command(),      new_command(),         check_command(),
        run_command(),       stop_command(),        status_command(),
        console_command(),   preview_command(),     simulate_command(),
        power_command(),     sequence_command(),    summary_command(),
        fit_command(),       stats_command(),       audit_command(),
        report_command(),    analysis_command(),    participant_command(),
        note_command(),      mark_command(),        session_command(),
        verify_command(),    sql_command(),         extension_command(),
        trace_command(),     export_command(),      merge_command(),
        push_command(),      calibrate_command(),   commission_command(),
        doctor_command(),    emulator_command(),    render_command(palpate::figures::thesis_feel),
        closest_command(),   deform_command(),      figures_command(),
        procedure_command(), screenshots_command(), words_command(all_commands)};
}

/// Everybody can list the words of a command (ps): the address of a server may hold a password.
void hide_addresses(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        if (char* scheme = std::strstr(argv[i], "://")) {
            std::memset(scheme + 3, '*', std::strlen(scheme + 3));
        }
    }
}

template <class... Kinds>
bool is_one_of(const std::exception& error) {
    return ((dynamic_cast<const Kinds*>(&error) != nullptr) || ...);
}

/// Says what went wrong. @return the exit code
int said(const std::exception& error) {
    using namespace palpate;
    if (is_one_of<protocols::ProtocolError, data::CsvError>(error)) {  // it begins with the file
        say_to(stderr, std::string(error.what()) + "\n");
        return kExitUsage;
    }
    if (is_one_of<std::bad_alloc>(error)) {
        warn("there is not enough memory: end other programs, and run this again");
        return kExitFailure;
    }
    warn("{}", error.what());
    return is_one_of<protocols::OrderError, data::WrongFile, std::invalid_argument>(error)
             ? kExitUsage
         : interrupted() ? kExitStopped
                         : kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is as a full disk
    try {
        const std::vector<Command> commands = all_commands();
        const ParseResult parsed = parse_command_line(commands, PALPATE_VERSION, argc, argv);
        hide_addresses(argc, argv);
        return heard(parsed.command ? commands[*parsed.command].run() : parsed.code);
    } catch (const std::exception& e) {
        const int code = said(e);
        static_cast<void>(let_readers_read());
        return code;
    }
}
