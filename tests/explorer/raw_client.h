#pragma once
// A client of plain sockets that does what it is told, right or wrong.

#include "explorer/message.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <optional>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

namespace nacre {

class RawClient {
public:
  explicit RawClient(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~RawClient() { close(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  bool connected() const { return connected_; }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  /// Resets the connection: as a process that was killed with data under way.
  void vanish() {
    const linger now{1, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close();
  }

  /// False once the server has closed.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return false;
      bytes.remove_prefix(std::size_t(n));
    }
    return true;
  }

  /// An HTTP answer, head and body; until the connection ends where no length is given. Empty: none in time.
  std::string http_answer() {
    while (received_.find("\r\n\r\n") == std::string::npos)
      if (!receive()) return std::exchange(received_, "");
    const std::size_t body = received_.find("\r\n\r\n") + 4;
    const std::size_t field = received_.find("Content-Length: ");
    std::size_t length = 0;
    if (field != std::string::npos && field < body) length = std::stoul(received_.substr(field + 16));
    while (received_.size() < body + length)
      if (!receive()) break;
    const std::string answer = received_.substr(0, body + length);
    received_.erase(0, answer.size());
    return answer;
  }

  /// Sends the handshake; the answer's head.
  std::string upgrade(int port, const std::string& token, const std::string& origin = "") {
    const std::string host = "127.0.0.1:" + std::to_string(port);
    send("GET /ws?token=" + token + " HTTP/1.1\r\nHost: " + host +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
         "Sec-WebSocket-Version: 13\r\nOrigin: " +
         (origin.empty() ? "http://" + host : origin) + "\r\n\r\n");
    return http_answer();
  }

  /// A frame as RFC 6455 section 5.2 has it, masked with zeros.
  static std::string frame(std::string_view payload, int opcode = 1, bool masked = true) {
    std::string f(1, char(0x80 | opcode));
    const auto mask = char(masked ? 0x80 : 0);
    if (payload.size() < 126) {
      f += char(mask | char(payload.size()));
    } else if (payload.size() < 65536) {
      f += char(mask | 126);
      f += char(payload.size() >> 8), f += char(payload.size());
    } else {
      f += char(mask | 127);
      for (int shift = 56; shift >= 0; shift -= 8)
        f += char(payload.size() >> shift);
    }
    if (masked) f += std::string(4, '\0');
    return f + std::string(payload);
  }
  bool say(std::string_view text) { return send(frame(text)); }

  /// The next text or binary message; none when the server closes or says nothing for a while. Pings are
  /// passed over.
  std::optional<Message> hear() {
    for (;;) {
      const auto need = [&](std::size_t n) {
        while (received_.size() < n)
          if (!receive()) return false;
        return true;
      };
      if (!need(2)) return std::nullopt;
      const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(received_[i])); };
      const std::size_t opcode = byte(0) & 15;
      std::size_t length = byte(1) & 127, head = 2;
      if (length >= 126) {
        const std::size_t n = length == 126 ? 2 : 8;
        if (!need(2 + n)) return std::nullopt;
        length = 0;
        for (std::size_t i = 0; i < n; ++i)
          length = length << 8 | byte(2 + i);
        head = 2 + n;
      }
      if (!need(head + length)) return std::nullopt;
      Message m{opcode == 2, received_.substr(head, length)};
      received_.erase(0, head + length);
      if (opcode == 8) {
        close_code = length >= 2 ? int(static_cast<unsigned char>(m.bytes[0])) << 8 |
                                       static_cast<unsigned char>(m.bytes[1])
                                 : 1005;
        return std::nullopt;
      }
      if (opcode == 1 || opcode == 2) return m;
    }
  }
  int close_code = 0;

private:
  bool receive() {
    pollfd waiting{fd_, POLLIN, 0};
    if (::poll(&waiting, 1, 20000) != 1) return false;
    char buffer[65536];
    const ssize_t n = ::recv(fd_, buffer, sizeof buffer, 0);
    if (n <= 0) return false;
    received_.append(buffer, std::size_t(n));
    return true;
  }

  int fd_;
  bool connected_ = false;
  std::string received_;
};

} // namespace nacre
