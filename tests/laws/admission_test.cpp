#include "data/store/database.hpp"
#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"

// Who may be run is asked before the rig's questions, which wait without limit, and again in the
// transaction that begins the session: by the shipped program, before a commissioned rig.

namespace {

/// What somebody does in another shell while a question waits, and what begins no session then.
struct Meanwhile {
    const char* name;
    Words before;  ///< of `palpate participant` and the file; none: there is no file yet
    Words does;    ///< the same, while it waits; none: the last person's session becomes real
    const char* refusal;
};

const Meanwhile kMeanwhile[]{
    {"consent",
     {"P1", "--new", "--consent", "yes"},
     {"P1", "--consent", "no"},
     "P1 is noted as not consenting"},
    {"handedness",
     {"P1", "--new", "--consent", "yes"},
     {"P1", "--handedness", "-90"},
     "asks for handedness \"right\", and P1 has a score of -90"},
    {"destruction",
     {"P1", "--new", "--consent", "yes"},
     {"P1", "--destroy", "everything", "--yes"},
     "P1 is noted as not consenting"},
    {"code", {"P2", "--new"}, {"p-1", "--new"}, "nobody is called P1, and p-1 is there"},
    {"file", {}, {"P1", "--new", "--consent", "no"}, "P1 is noted as not consenting"},
    {"version",
     {"P1", "--new", "--consent", "yes"},
     {},
     "ran another version of four_trials: apparatus stiffness_n_per_m"},
};

}  // namespace

TEST_CASE("what is noted or run while the rig's questions wait is asked for as the session begins",
          "[commission][haply][consent][law]") {
    const Meanwhile& one = GENERATE(from_range(std::begin(kMeanwhile), std::end(kMeanwhile)));
    CAPTURE(one.name);
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    FreeBoard board(folder);
    const std::string words = ran_words(folder, board.word()) + " --kind real --calibration '" +
                              commissioned_rig(folder, board.word()) + "'";
    const std::string study = slurp(folder.file("p.toml"));
    write(folder.file("p.toml"),
          replaced(study, "participants = 1", "participants = 1\nhandedness = \"right\""));
    Finished end;
    for (int tries = 0; tries < 8 && (tries == 0 || starved(end.error)); ++tries) {
        for (const char* more : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file + more);
        }
        if (one.does.empty()) {
            write(folder.file("other.toml"),
                  replaced(study, "stiffness_n_per_m = 200", "stiffness_n_per_m = 250"));
            ran({"simulate", folder.file("other.toml"), "--participants", "1", "--db", file});
        }
        if (!one.before.empty()) {
            ran(joined({"participant", file}, one.before));
        }
        board.bring("0,89.3");
        TypedTo run(folder, fmt::format("run{}", tries), words, {"SDL_VIDEODRIVER=dummy"});
        REQUIRE(run.program().says("Type yes:"));
        if (one.does.empty()) {
            data::Database(file, data::Access::write)
                .execute("UPDATE session SET session_kind = 'real'");
        } else {
            ran(joined({"participant", file}, one.does));
        }
        operate(run, board, "If it ends early");
        run.program().signal(SIGTERM);
        end = run.program().wait();
    }
    CAPTURE(end.out);
    check_end(end, 2, Has(one.refusal));
    data::Database database(file, data::Access::read);
    CHECK(database
              .first("SELECT count(*) FROM session JOIN participant USING (participant_id) WHERE "
                     "participant_code = 'P1'")
              .integer(0) == 0);
}
