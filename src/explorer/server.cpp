#include "explorer/server.h"

#include "core/error.h"

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <fmt/format.h>
#include <set>
#include <sys/random.h>

namespace nacre {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;
using std::chrono::seconds;

std::string random_token() {
  std::array<unsigned char, 16> bytes;
  if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    throw Error("the system gives no random numbers, which the explorer's token is made of");
  std::string text;
  for (const unsigned char b : bytes)
    text += fmt::format("{:02x}", b);
  return text;
}

/// Takes as long for a wrong text as for the right one.
bool same_secret(std::string_view a, std::string_view b) {
  unsigned char difference = a.size() != b.size();
  for (std::size_t i = 0; i < b.size(); ++i)
    difference |= static_cast<unsigned char>((i < a.size() ? a[i] : '\0') ^ b[i]);
  return difference == 0;
}

/// The value of a field of an address's query, percent signs decoded; empty if there is none.
std::string query_value(std::string_view target, std::string_view name) {
  const std::size_t mark = target.find('?');
  if (mark == std::string_view::npos) return "";
  std::string_view rest = target.substr(mark + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view field = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos || field.substr(0, equals) != name) continue;
    std::string value;
    const std::string_view coded = field.substr(equals + 1);
    const auto digit = [](char c) {
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    for (std::size_t i = 0; i < coded.size(); ++i) {
      const int hi = i + 2 < coded.size() ? digit(coded[i + 1]) : -1, lo = hi >= 0 ? digit(coded[i + 2]) : -1;
      if (coded[i] == '%' && lo >= 0) {
        value += char(hi * 16 + lo);
        i += 2;
      } else {
        value += coded[i] == '+' ? ' ' : coded[i];
      }
    }
    return value;
  }
  return "";
}

std::string_view content_type(std::string_view path) {
  const auto ends = [&](std::string_view ending) { return path.ends_with(ending); };
  if (path == "/" || ends(".html")) return "text/html; charset=utf-8";
  if (ends(".js") || ends(".mjs")) return "text/javascript; charset=utf-8";
  if (ends(".css")) return "text/css; charset=utf-8";
  if (ends(".json") || ends(".map")) return "application/json";
  if (ends(".svg")) return "image/svg+xml";
  if (ends(".png")) return "image/png";
  if (ends(".wasm")) return "application/wasm";
  if (ends(".woff2")) return "font/woff2";
  return ends(".txt") ? "text/plain; charset=utf-8" : "application/octet-stream";
}

/// Bytes that are read and dropped, and seconds that are waited, so that a connection ends without a reset.
constexpr std::size_t most_dropped = 96u << 20;
constexpr seconds longest_drain{2};

/// The stream of a page. Beast closes the socket of a WebSocket that ends with what the page has sent still
/// unread. That is a reset of the connection, with which the page loses the close code that was sent to it.
class PageStream : public beast::tcp_stream {
public:
  using beast::tcp_stream::tcp_stream;
};

template <class Handler>
class Drain : public std::enable_shared_from_this<Drain<Handler>> {
public:
  Drain(PageStream& stream, Handler handler) : stream_(stream), handler_(std::move(handler)) {}
  void read() {
    stream_.async_read_some(asio::buffer(dropped_),
                            [self = this->shared_from_this()](ErrorCode error, std::size_t n) {
                              self->count_ += n;
                              if (!error && self->count_ < most_dropped) return self->read();
                              self->stream_.close();
                              self->handler_(ErrorCode());
                            });
  }

private:
  PageStream& stream_;
  Handler handler_;
  std::array<char, 65536> dropped_;
  std::size_t count_ = 0;
};

/// Found by Beast in place of its own.
template <class Handler>
void async_teardown(beast::role_type, PageStream& stream, Handler&& handler) {
  ErrorCode ignored;
  stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
  stream.expires_after(longest_drain);
  std::make_shared<Drain<std::decay_t<Handler>>>(stream, std::forward<Handler>(handler))->read();
}

std::string_view as_view(beast::string_view text) { return {text.data(), text.size()}; }

} // namespace

namespace {
class Page;
}

struct Server::Impl {
  explicit Impl(ServerOptions o) : options(std::move(o)), token(random_token()), acceptor(io) {}

  ServerOptions options;
  std::string token;
  int port = 0;
  int connections = 0;
  std::set<Page*> pages;
  std::set<std::filesystem::path> uploading; ///< files that are arriving
  // What goes first when the server ends: connections go with it, and refer to all the above.
  asio::io_context io{1};
  tcp::acceptor acceptor;

  /// The names under which a browser on this machine reaches the server.
  bool is_own_host(std::string_view host) const {
    return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
  }
  bool is_own_origin(std::string_view origin) const {
    return origin.starts_with("http://") && is_own_host(origin.substr(7));
  }
  void accept();
};

namespace {

/// One WebSocket. Everything runs on the server's thread but `send`, which posts.
class Page : public std::enable_shared_from_this<Page> {
public:
  Page(Server::Impl& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    server_.pages.insert(this);
  }
  ~Page() { end(); }

  template <class R>
  void start(R request) {
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.auto_fragment(false); // pictures go as they lie in memory
    stream_.read_message_max(server_.options.max_message);
    auto kept = std::make_shared<R>(std::move(request));
    stream_.async_accept(*kept, [self = shared_from_this(), kept](ErrorCode error) {
      if (error) return self->end();
      self->open();
    });
  }

  void end() {
    if (ended_) return;
    ended_ = true;
    server_.pages.erase(this);
    if (connection_) connection_->close();
    // Outstanding operations end with an error, and with them goes the page.
    beast::get_lowest_layer(stream_).close();
  }

private:
  void open() {
    // Never called after connection_->close(), so that the server is there.
    connection_ =
        server_.options.open([weak = weak_from_this(), &io = server_.io](Message message, bool droppable) {
          asio::post(io, [weak, message = std::move(message), droppable]() mutable {
            if (const auto self = weak.lock()) self->send(std::move(message), droppable);
          });
        });
    read();
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      if (error) return self->end(); // for a message too large the stream has sent close code 1009 already
      const auto bytes = self->buffer_.data();
      const std::string_view text(static_cast<const char*>(bytes.data()), bytes.size());
      // A page sends texts; anything else is answered like a text that is no request.
      self->connection_->receive(self->stream_.got_text() ? text : std::string_view("binary"));
      self->buffer_.consume(self->buffer_.size());
      // A long message leaves a long buffer.
      if (self->buffer_.capacity() > (1u << 20)) self->buffer_.shrink_to_fit();
      self->read();
    });
  }

  void send(Message message, bool droppable) {
    if (ended_ || (droppable && unsent_ > 0 && waiting_.size() > 2)) return;
    unsent_ += message.bytes.size();
    waiting_.push_back(std::move(message));
    if (unsent_ > server_.options.max_unsent) return end();
    if (waiting_.size() == 1) write();
  }

  void write() {
    stream_.binary(waiting_.front().is_binary);
    stream_.async_write(asio::buffer(waiting_.front().bytes),
                        [self = shared_from_this()](ErrorCode error, std::size_t) {
                          if (error || self->ended_) return self->end();
                          self->unsent_ -= self->waiting_.front().bytes.size();
                          self->waiting_.pop_front();
                          if (!self->waiting_.empty()) self->write();
                        });
  }

  Server::Impl& server_;
  websocket::stream<PageStream> stream_;
  beast::flat_buffer buffer_;
  std::deque<Message> waiting_; ///< the first one is being written
  std::size_t unsent_ = 0;
  std::unique_ptr<PageConnection> connection_;
  bool ended_ = false;
};

/// One HTTP connection, until it becomes a page or ends.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
public:
  HttpConnection(Server::Impl& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    ++server_.connections;
  }
  ~HttpConnection() {
    abandon_upload();
    --server_.connections;
  }

  void read() {
    header_.emplace();
    header_->header_limit(16 << 10);
    header_->body_limit(server_.options.max_upload);
    stream_.expires_after(seconds(30));
    http::async_read_header(
        stream_, buffer_, *header_, [self = shared_from_this()](ErrorCode error, std::size_t) {
          if (error == http::error::body_limit) return self->refuse_size();
          if (error == http::error::end_of_stream || error == beast::error::timeout) return self->shut();
          if (error && error.category() == http::make_error_code(http::error::bad_method).category())
            return self->refuse(http::status::bad_request, "not an HTTP request: " + error.message());
          if (error) return;
          self->handle();
        });
  }

private:
  void handle() {
    const auto& request = header_->get();
    const std::string target(as_view(request.target()));
    const std::string path = target.substr(0, target.find('?'));
    if (!server_.is_own_host(as_view(request[http::field::host])))
      return refuse(http::status::forbidden, "this server answers to its own address alone");
    const std::string_view origin = as_view(request[http::field::origin]);
    if (!origin.empty() && !server_.is_own_origin(origin))
      return refuse(http::status::forbidden,
                    fmt::format("requests of pages from '{}' are refused", origin.substr(0, 100)));
    if (path == "/ws" || path == "/upload") {
      if (!same_secret(query_value(target, "token"), server_.token))
        return refuse(http::status::forbidden, "the token is missing or is not that of this start: open the "
                                               "address that 'nacre explore' printed");
      return path == "/ws" ? upgrade() : upload(query_value(target, "name"));
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(http::status::method_not_allowed, "only GET is answered here");
    for (const PageFile& file : server_.options.page)
      if (file.path == path || (path == "/index.html" && file.path == "/")) return serve(file);
    refuse(http::status::not_found, fmt::format("there is no '{}'", path.substr(0, 100)));
  }

  void upgrade() {
    if (!websocket::is_upgrade(header_->get()))
      return refuse(http::status::upgrade_required, "expected a WebSocket handshake");
    if (int(server_.pages.size()) >= server_.options.max_pages)
      return refuse(http::status::service_unavailable,
                    fmt::format("{} pages are open already", server_.pages.size()));
    stream_.expires_never();
    std::make_shared<Page>(server_, stream_.release_socket())->start(header_->release());
  }

  void upload(const std::string& name) {
    if (header_->get().method() != http::verb::post)
      return refuse(http::status::method_not_allowed, "a file is sent by POST");
    try {
      upload_path_ = server_.options.upload_path(name);
    } catch (const Error& e) {
      return refuse(http::status::bad_request, e.what());
    }
    if (!server_.uploading.insert(upload_path_).second)
      return refuse(http::status::conflict, "a file of this name is arriving already");
    arriving_ = true;
    body_.emplace(std::move(*header_));
    ErrorCode error;
    body_->get().body().open((upload_path_.string() + ".part").c_str(), beast::file_mode::write, error);
    if (error)
      return fail_upload(http::status::insufficient_storage, "the file cannot be stored: " + error.message());
    if (as_view(body_->get()[http::field::expect]) == "100-continue") {
      auto go_on = std::make_shared<http::response<http::empty_body>>(http::status::continue_, 11);
      return http::async_write(stream_, *go_on, [self = shared_from_this(), go_on](ErrorCode e, std::size_t) {
        if (!e) self->receive();
      });
    }
    receive();
  }

  void receive() {
    stream_.expires_after(seconds(30));
    http::async_read_some(stream_, buffer_, *body_,
                          [self = shared_from_this()](ErrorCode error, std::size_t) {
                            if (error == http::error::body_limit) {
                              self->abandon_upload();
                              return self->refuse_size();
                            }
                            if (error && error != http::error::end_of_stream &&
                                error.category() == boost::system::generic_category())
                              return self->fail_upload(http::status::insufficient_storage,
                                                       "the file cannot be stored: " + error.message());
                            if (error) return self->abandon_upload(); // vanished in the middle
                            if (!self->body_->is_done()) return self->receive();
                            self->finish_upload();
                          });
  }

  void finish_upload() {
    body_->get().body().close();
    std::error_code error;
    std::filesystem::rename(upload_path_.string() + ".part", upload_path_, error);
    server_.uploading.erase(upload_path_);
    arriving_ = false;
    if (error)
      return refuse(http::status::insufficient_storage, "the file cannot be stored: " + error.message());
    const nlohmann::json answer{{"file", server_.options.uploaded_name(upload_path_)}};
    respond(http::status::ok, "application/json",
            answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

  void abandon_upload() {
    if (!arriving_) return;
    arriving_ = false;
    body_->get().body().close();
    std::error_code ignored;
    std::filesystem::remove(upload_path_.string() + ".part", ignored);
    server_.uploading.erase(upload_path_);
  }
  void fail_upload(http::status status, const std::string& why) {
    abandon_upload();
    refuse(status, why);
  }

  void refuse_size() {
    refuse(http::status::payload_too_large,
           fmt::format("a file of at most {} MiB is taken", server_.options.max_upload >> 20));
  }
  /// What follows of a refused request is not read: the connection ends.
  void refuse(http::status status, const std::string& why) {
    keep_alive_ = false;
    respond(status, "text/plain; charset=utf-8", why + "\n");
  }

  template <class B>
  void set_fields(http::response<B>& response, std::string_view type) {
    response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer"); // the address holds the token
    response.set(http::field::cache_control, "no-store");
    response.set("Content-Security-Policy",
                 "default-src 'self'; img-src 'self' data: blob:; style-src 'self' "
                 "'unsafe-inline'; worker-src 'self' blob:; frame-ancestors 'none'");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.keep_alive(keep_alive_);
  }

  void respond(http::status status, std::string_view type, std::string text) {
    auto response = std::make_shared<http::response<http::string_body>>(status, 11);
    response->body() = std::move(text);
    set_fields(*response, type);
    response->prepare_payload();
    write(response);
  }

  void serve(const PageFile& file) {
    keep_alive_ = header_->get().keep_alive();
    using Body = http::span_body<const char>;
    auto response = std::make_shared<http::response<Body>>(http::status::ok, 11);
    if (header_->get().method() == http::verb::get)
      response->body() = beast::span<const char>(file.bytes.data(), file.bytes.size());
    set_fields(*response, content_type(file.path));
    response->content_length(file.bytes.size());
    write(response);
  }

  template <class Response>
  void write(std::shared_ptr<Response> response) {
    stream_.expires_after(seconds(30));
    auto serializer = std::make_shared<http::response_serializer<typename Response::body_type>>(*response);
    const bool head = header_ && header_->get().method() == http::verb::head;
    const auto done = [self = shared_from_this(), response, serializer](ErrorCode error, std::size_t) {
      if (error) return;
      if (self->keep_alive_) return self->read();
      self->shut();
    };
    if (head)
      http::async_write_header(stream_, *serializer, done);
    else
      http::async_write(stream_, *serializer, done);
  }

  /// A socket closed with bytes unread resets the connection, and the answer may be lost: they are read for a
  /// while and dropped.
  void shut() {
    ErrorCode ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(seconds(2));
    drain();
  }
  void drain() {
    stream_.async_read_some(asio::buffer(dropped_),
                            [self = shared_from_this()](ErrorCode error, std::size_t) {
                              if (!error && ++self->drained_ < 4096) self->drain();
                            });
  }

  Server::Impl& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{64 << 10};
  std::optional<http::request_parser<http::empty_body>> header_;
  std::optional<http::request_parser<http::file_body>> body_;
  std::filesystem::path upload_path_;
  std::array<char, 16384> dropped_;
  int drained_ = 0;
  bool keep_alive_ = false, arriving_ = false;
};

} // namespace

void Server::Impl::accept() {
  acceptor.async_accept([this](ErrorCode error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    constexpr int most_connections = 256;
    if (!error && connections < most_connections) {
      ErrorCode ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<HttpConnection>(*this, std::move(socket))->read();
    }
    if (!error) return accept();
    // No descriptors left, perhaps: try again a little later.
    auto timer = std::make_shared<asio::steady_timer>(io, std::chrono::milliseconds(100));
    timer->async_wait([this, timer](ErrorCode) { accept(); });
  });
}

Server::Server(ServerOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {
  Impl& s = *impl_;
  const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), static_cast<unsigned short>(s.options.port));
  ErrorCode error;
  s.acceptor.open(endpoint.protocol(), error);
  if (!error) s.acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) s.acceptor.bind(endpoint, error);
  if (!error) s.acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw Error(fmt::format("port {} cannot be listened on: {}; --port 0 takes any free one", s.options.port,
                            error.message()));
  s.port = s.acceptor.local_endpoint().port();
  s.accept();
}

Server::~Server() {
  // Workers send nothing from here on.
  while (!impl_->pages.empty())
    (*impl_->pages.begin())->end();
}
int Server::port() const { return impl_->port; }
const std::string& Server::token() const { return impl_->token; }
std::string Server::address() const {
  return fmt::format("http://127.0.0.1:{}/?token={}", impl_->port, impl_->token);
}
void Server::run() { impl_->io.run(); }
void Server::stop() { impl_->io.stop(); }

} // namespace nacre
