#pragma once

#include "tests/support/process.hpp"

namespace palpate::tests {

/// A PostgreSQL server of the test's own: in a temporary folder, on a free port of the loopback,
/// run by an ordinary user. Gone at the end.
class PostgresServer {
public:
    /// Nothing where PostgreSQL is not installed.
    /// @param certificate, key  PEM files of a server that talks TLS alone; copied
    static std::unique_ptr<PostgresServer> start(const std::string& certificate = {},
                                                 const std::string& key = {});

    /// Stops at once, as by a power cut of the machine it runs on, and starts again.
    void crash_and_restart();

    [[nodiscard]] int port() const { return port_; }
    /// postgresql://postgres:PASSWORD@127.0.0.1:PORT/DATABASE
    [[nodiscard]] std::string url(const std::string& database = "postgres",
                                  const std::string& user = "postgres") const;
    static constexpr const char* kPassword = "not-to-be-said";

private:
    PostgresServer() = default;
    void make(const std::string& certificate, const std::string& key);
    void run();

    TemporaryFolder folder_;
    std::string programs_;
    bool tls_ = false;
    int port_ = 0;
    std::unique_ptr<Process> process_;
};

}  // namespace palpate::tests
