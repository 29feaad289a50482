// Notifications to systemd from a service started with Type=notify.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <thread>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"

namespace trivet {
namespace {

/// The service manager's end of the socket.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un here{};
    here.sun_family = AF_UNIX;
    std::strncpy(here.sun_path, path.c_str(), sizeof here.sun_path - 1);
    is_bound_ = ::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0;
    const timeval patience{60, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;
  ~NotifySocket() { ::close(socket_); }

  bool is_bound() const { return is_bound_; }
  std::string receive() const {
    char text[256];
    const ssize_t n = ::recv(socket_, text, sizeof text, 0);
    return {text, n > 0 ? static_cast<std::size_t>(n) : 0};
  }
  /// The next state that is no watchdog ping.
  std::string next_state() const {
    std::string state = receive();
    while (state == "WATCHDOG=1") state = receive();
    return state;
  }

 private:
  int socket_;
  bool is_bound_ = false;
};

class NotifySystemd : public test::ServeFixture {};

TEST_F(NotifySystemd, ReportsEachState) {
  const std::string path = folder_ / "notify";
  const NotifySocket manager(path);
  ASSERT_TRUE(manager.is_bound());
  environment_ = {"NOTIFY_SOCKET=" + path, "WATCHDOG_USEC=200000"};
  const test::Outcome outcome = serve({}, [&](int port) {
    EXPECT_EQ(manager.next_state(), "READY=1");
    EXPECT_EQ(manager.receive(), "WATCHDOG=1");
    EXPECT_EQ(manager.receive(), "WATCHDOG=1");
    kill(process_, SIGHUP);
    EXPECT_EQ(manager.next_state(), "RELOADING=1");
    EXPECT_EQ(manager.next_state(), "READY=1");
    EXPECT_EQ(test::ask(port, "GET", "/v1/models").json()["generation"], 2);
    request_end();
    EXPECT_EQ(manager.next_state(), "STOPPING=1");
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(NotifySystemd, NothingIsSentWithoutASocket) {
  environment_ = {"NOTIFY_SOCKET=" + (folder_ / "nobody").string(), "WATCHDOG_USEC=soon"};
  const test::Outcome outcome =
      serve({}, [&](int port) { EXPECT_EQ(test::ask(port, "GET", "/v2").status, 200); });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST(SystemdUnit, IsWellFormed) {
  if (std::string(TRIVET_SYSTEMD_ANALYZE).empty()) GTEST_SKIP() << "systemd is not installed";
  const test::TempDir folder;
  std::string unit = test::read_bytes(std::string(TRIVET_SOURCES) + "/docs/deploy/trivet.service");
  const std::string program = "/usr/local/bin/trivet";
  ASSERT_NE(unit.find(program), std::string::npos);
  unit.replace(unit.find(program), program.size(), TRIVET_PROGRAM);
  folder.write("trivet.service", unit);
  const test::Outcome checked =
      test::run_program(TRIVET_SYSTEMD_ANALYZE, {"verify", folder / "trivet.service"},
                        {.folder = folder.path(), .environment = {}, .watch = {}});
  EXPECT_EQ(checked.exit_code, 0);
  EXPECT_EQ(checked.out + checked.error, "");
}

}  // namespace
}  // namespace trivet
