#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>

#include "protocols/file/protocol_file.hpp"
#include "protocols/order/constrained_order.hpp"
#include "data/csv/number_table.hpp"
#include "data/store/statement.hpp"
#include "ui/cli/commands.hpp"
#include "ui/rig/say.hpp"

namespace {

using namespace palpate::ui;

int dispatch(const Options& options) {
    struct Visitor {
        int operator()(const Exit& exit) const { return exit.code; }
        int operator()(const RunOptions& run) const { return run_command(run); }
        int operator()(const SequenceOptions& plan) const { return sequence_command(plan); }
        int operator()(const CheckOptions& check) const { return check_command(check); }
        int operator()(const NewOptions& words) const { return new_command(words); }
        int operator()(const DemoOptions& demo) const { return demo_command(demo); }
        int operator()(const SummaryOptions& summary) const { return summary_command(summary); }
        int operator()(const ParticipantOptions& who) const { return participant_command(who); }
        int operator()(const NoteOptions& note) const { return note_command(note); }
        int operator()(const MarkOptions& mark) const { return mark_command(mark); }
        int operator()(const TraceOptions& trace) const { return trace_command(trace); }
        int operator()(const VerifyOptions& verify) const { return verify_command(verify); }
        int operator()(const SqlOptions& sql) const { return sql_command(sql); }
        int operator()(const ExtensionOptions& /*none*/) const { return extension_command(); }
        int operator()(const ExportCommandOptions& words) const { return export_command(words); }
        int operator()(const MergeOptions& files) const { return merge_command(files); }
        int operator()(const PushOptions& push) const { return push_command(push); }
        int operator()(const ScreenshotOptions& shots) const { return screenshots_command(shots); }
        int operator()(const RenderOptions& render) const { return render_command(render); }
        int operator()(const ClosestOptions& closest) const { return closest_command(closest); }
        int operator()(const ProcedureOptions& procedure) const {
            return procedure_command(procedure);
        }
        int operator()(const FigureOptions& figures) const { return figures_command(figures); }
        int operator()(const CalibrateOptions& words) const { return calibrate_command(words); }
        int operator()(const DoctorOptions& doctor) const { return doctor_command(doctor); }
        int operator()(const EmulatorOptions& board) const { return emulator_command(board); }
    };
    return std::visit(Visitor{}, options);
}

/// Everybody can list the words of a command (ps): the address of a server may hold a password.
void hide_addresses(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        if (char* scheme = std::strstr(argv[i], "://")) {
            std::memset(scheme + 3, '*', std::strlen(scheme + 3));
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Options options = parse_command_line(argc, argv);
        hide_addresses(argc, argv);
        return dispatch(options);
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
        return kExitFailure;
    }
}
