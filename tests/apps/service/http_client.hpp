/// An HTTP client for tests, which can send and receive byte by byte.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <thread>
#include <utility>

namespace trivet::test {

/// A connection that a test writes to and reads from byte by byte.
class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(static_cast<std::uint16_t>(port));
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{60, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    is_open_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&where), sizeof where) == 0;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    if (socket_ >= 0) ::close(socket_);
  }

  bool is_open() const { return is_open_; }
  void send(const std::string& text) const {
    for (std::size_t sent = 0; sent < text.size();) {
      const ssize_t n = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) return;
      sent += static_cast<std::size_t>(n);
    }
  }
  /// Closes the sending side.
  void finish() const { ::shutdown(socket_, SHUT_WR); }
  /// Resets the connection, as a client does that dies before it has read a response.
  void abort() {
    const linger at_once{1, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(std::exchange(socket_, -1));
  }
  /// Receives until the other side closes.
  std::string receive() const {
    std::string all;
    char part[65536];
    for (ssize_t n = 0; (n = ::recv(socket_, part, sizeof part, 0)) > 0;)
      all.append(part, static_cast<std::size_t>(n));
    return all;
  }

 private:
  int socket_;
  bool is_open_ = false;
};

struct Answer {
  int status = 0;
  std::string head, body;
  double seconds = 0;
  nlohmann::json json() const { return nlohmann::json::parse(body, nullptr, false); }
};

/// The first response in the received bytes; none: status 0.
inline Answer parse_answer(const std::string& received) {
  Answer answer;
  const std::size_t end = received.find("\r\n\r\n");
  if (end == std::string::npos || received.size() < 12) return answer;
  answer.status = std::stoi(received.substr(9, 3));
  answer.head = received.substr(0, end);
  std::smatch length;
  const bool has_length =
      std::regex_search(answer.head, length, std::regex("\r\nContent-Length: ([0-9]+)"));
  answer.body = received.substr(end + 4, has_length ? std::stoul(length[1]) : received.npos);
  return answer;
}

inline Answer ask(int port, const std::string& method, const std::string& target,
                  const std::string& body = "", const std::string& headers = "") {
  const auto start = std::chrono::steady_clock::now();
  const Connection connection(port);
  connection.send(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                  headers + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  Answer answer = parse_answer(connection.receive());
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return answer;
}

/// A free port, for programs that cannot choose one.
inline int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof where;
  ::bind(socket, reinterpret_cast<const sockaddr*>(&where), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&where), &size);
  ::close(socket);
  return ntohs(where.sin_port);
}

/// Waits up to a minute for a condition.
inline bool comes(const std::function<bool()>& condition) {
  const auto patience = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::chrono::steady_clock::now() < patience) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

}  // namespace trivet::test
