#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "protocols/file/protocol_file.hpp"
#include "protocols/order/constrained_order.hpp"
#include "data/csv/number_table.hpp"
#include "data/store/statement.hpp"
#include "ui/command/command.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/rig/say.hpp"
#include "ui/session/version.hpp"

namespace palpate::ui {

// Every command, each in its file, in the order of --help: declared here, listed below.
Command demo_command(), new_command(), check_command(), run_command(), stop_command(),
    simulate_command(), power_command(), sequence_command(), summary_command(), fit_command(),
    stats_command(), audit_command(), report_command(), analysis_command(), participant_command(),
    note_command(), mark_command(), session_command(), verify_command(), sql_command(),
    extension_command(), trace_command(), export_command(), merge_command(), push_command(),
    calibrate_command(), commission_command(), doctor_command(), emulator_command(),
    render_command(), closest_command(), deform_command(), figures_command(), procedure_command(),
    screenshots_command();
Command words_command(std::vector<Command> (*all)());

}  // namespace palpate::ui

namespace {

using namespace palpate::ui;

std::vector<Command> all_commands() {
    return {demo_command(),      new_command(),         check_command(),
            run_command(),       stop_command(),        simulate_command(),
            power_command(),     sequence_command(),    summary_command(),
            fit_command(),       stats_command(),       audit_command(),
            report_command(),    analysis_command(),    participant_command(),
            note_command(),      mark_command(),        session_command(),
            verify_command(),    sql_command(),         extension_command(),
            trace_command(),     export_command(),      merge_command(),
            push_command(),      calibrate_command(),   commission_command(),
            doctor_command(),    emulator_command(),    render_command(),
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

/// A full disk behind standard output is no success. Who closes a pipe has read enough.
int heard(int code) {
    struct stat out {};
    const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
    if (code != 0 || !lost || (fstat(STDOUT_FILENO, &out) == 0 && S_ISFIFO(out.st_mode))) {
        return code;
    }
    warn("standard output: cannot be written; check the space on the disk");
    return kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::vector<Command> commands = all_commands();
        const Parsed parsed = parse_command_line(commands, kVersion, argc, argv);
        hide_addresses(argc, argv);
        return heard(parsed.command ? commands[*parsed.command].run() : parsed.code);
    } catch (const palpate::protocols::ProtocolError& e) {
        say_to(stderr, std::string(e.what()) + "\n");
        return kExitUsage;
    } catch (const palpate::protocols::OrderError& e) {  // the file asks for what cannot be had
        warn("{}", e.what());
        return kExitUsage;
    } catch (const palpate::data::CsvError& e) {
        say_to(stderr, std::string(e.what()) + "\n");
        return kExitUsage;
    } catch (const palpate::data::WrongFile& e) {
        warn("{}", e.what());
        return kExitUsage;
    } catch (const std::invalid_argument& e) {
        warn("{}", e.what());
        return kExitUsage;
    } catch (const std::exception& e) {
        warn("{}", e.what());
        return interrupted() ? kExitStopped : kExitFailure;
    }
}
