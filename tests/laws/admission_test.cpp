#include "tests/support/free_board.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

// Who may be run is asked before the rig's questions, which wait without limit, and again in the
// transaction that begins the session: by the shipped program, before a commissioned rig.

TEST_CASE("what is noted or run while the rig's questions wait is asked for as the session begins",
          "[haply]") {
    EACH(one, from_range(test_rows("meanwhile.tsv")));
    const std::string& before = one.at(1);
    const std::string& does = one.at(2);
    const TemporaryFolder folder;
    const std::string file = folder.file("d.sqlite");
    FreeBoard board(folder);
    const std::string words = real_words(folder, board, commissioned_rig(folder, board.word()));
    const std::string study = slurp(folder.file("p.toml"));
    write(folder.file("p.toml"),
          replaced(study, "participants = 1", "participants = 1\nhandedness = \"right\""));
    Finished end;
    for (int tries = 0; tries < 8 && (tries == 0 || starved(end.error)); ++tries) {
        for (const char* more : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file + more);
        }
        if (does.empty()) {
            write(folder.file("other.toml"),
                  replaced(study, "stiffness_n_per_m = 200", "stiffness_n_per_m = 250"));
            ran({"simulate", folder.file("other.toml"), "--participants", "1", "--db", file});
        }
        if (!before.empty()) {
            ran(joined({"participant"}, words_of(file, before)));
        }
        board.bring("0,89.3");
        TypedTo run(folder, fmt::format("run{}", tries), words, {"SDL_VIDEODRIVER=dummy"});
        REQUIRE(run.program().says("Type yes:"));
        if (does.empty()) {
            sql_edit(file, "UPDATE session SET session_kind = 'real'");
        } else {
            ran(joined({"participant"}, words_of(file, does)));
        }
        operate(run, board, "If it ends early");
        run.program().signal(SIGTERM);
        end = run.program().wait();
    }
    CAPTURE(end.out);
    check_end(end, 2, Has(one.at(3)));
    CHECK(sql_first(file,
                    "SELECT count(*) FROM session JOIN participant USING (participant_id) WHERE "
                    "participant_code = 'P1'") == "0");
}
