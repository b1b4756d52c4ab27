#include "tests/support/postgres_server.hpp"

#include "tests/support/udp_port.hpp"

namespace palpate::tests {
namespace {

namespace fs = std::filesystem;

constexpr uid_t kNobody = 65534;

/// The folder of the newest server programs; empty: there are none.
std::string find_programs() {
    std::string found;
    std::error_code none;
    for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", none)) {
        const fs::path programs = version.path() / "bin";
        if (fs::exists(programs / "initdb") && fs::exists(programs / "postgres") &&
            programs.string() > found) {
            found = programs.string();
        }
    }
    return found;
}

/// The server refuses to run as root.
Words as_ordinary_user(Words command) {
    if (geteuid() == 0) {
        const std::string id = fmt::format("{}", kNobody);
        command.insert(command.begin(),
                       {"setpriv", "--reuid=" + id, "--regid=" + id, "--clear-groups",
                        // Changing the user forgets what Process asked for.
                        "--pdeathsig", "KILL"});
    }
    return command;
}

/// Gives files to the user that the server runs as.
void own(const Words& files) {
    for (const std::string& file : files) {
        if (geteuid() == 0 && chown(file.c_str(), kNobody, kNobody) != 0) {
            throw std::runtime_error("cannot give " + file + " to an ordinary user");
        }
    }
}

bool answers(const std::string& programs, int port) {
    return Process(
               {programs + "/pg_isready", "-q", "-h", "127.0.0.1", "-p", fmt::format("{}", port)})
               .wait()
               .code == 0;
}

}  // namespace

std::unique_ptr<PostgresServer> PostgresServer::start(const std::string& certificate,
                                                      const std::string& key) {
    const std::string programs = find_programs();
    if (programs.empty()) {
        return nullptr;
    }
    auto server = std::unique_ptr<PostgresServer>(new PostgresServer);
    server->programs_ = programs;
    server->make(certificate, key);
    server->run();
    return server;
}

void PostgresServer::make(const std::string& certificate, const std::string& key) {
    const std::string data = folder_.file("data");
    const std::string word = folder_.file("word");
    fs::create_directory(data);
    std::ofstream(word) << kPassword << '\n';
    own({folder_.path().string(), data, word});
    const Finished made =
        Process(as_ordinary_user({programs_ + "/initdb", "-D", data, "-U", "postgres", "-A",
                                  "scram-sha-256", "--pwfile=" + word, "--no-sync", "-E", "UTF8",
                                  "--locale=C"}))
            .wait();
    if (made.code != 0) {
        throw std::runtime_error("initdb: " + made.error);
    }
    tls_ = !certificate.empty();
    if (tls_) {
        fs::copy_file(certificate, data + "/server.crt");
        fs::copy_file(key, data + "/server.key");
        fs::permissions(data + "/server.key", fs::perms::owner_read | fs::perms::owner_write);
        std::ofstream(data + "/pg_hba.conf") << "hostssl all all 127.0.0.1/32 scram-sha-256\n";
        own({data + "/server.crt", data + "/server.key"});
    }
    port_ = free_port(SOCK_STREAM);
}

void PostgresServer::run() {
    const std::string data = folder_.file("data");
    process_ = std::make_unique<Process>(as_ordinary_user(
        {programs_ + "/postgres", "-D", data, "-p", fmt::format("{}", port_), "-h", "127.0.0.1",
         "-k", "", "-c", "fsync=off", "-c", tls_ ? "ssl=on" : "ssl=off"}));
    for (int i = 0; i < 3000 && process_->running() && !answers(programs_, port_); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (!answers(programs_, port_)) {
        throw std::runtime_error("postgres: " + process_->wait(std::chrono::seconds(1)).error);
    }
}

void PostgresServer::crash_and_restart() {
    process_->signal(SIGQUIT);  // what its manual calls immediate shutdown
    process_->wait();
    run();
}

std::string PostgresServer::url(const std::string& database, const std::string& user) const {
    return fmt::format("postgresql://{}:{}@127.0.0.1:{}/{}", user, kPassword, port_, database);
}

}  // namespace palpate::tests
