#include "explorer/jobs.h"

#include "core/cancellation.h"
#include "core/parallel.h"

#include <new>

namespace nacre {
namespace {

/// A page that asks for more at once gets an error: no page does that.
constexpr std::size_t most_open = 512;
constexpr int most_slow = 12;

} // namespace

PageJobs::PageJobs(Jobs& jobs, Send send) : jobs_(jobs), send_(std::move(send)) {
  quick_.most = jobs.at_once_;
}

void PageJobs::say(Message message, bool droppable) {
  const std::lock_guard lock(sending_);
  if (send_) send_(std::move(message), droppable);
}

void PageJobs::close() {
  {
    const std::lock_guard lock(sending_);
    send_ = nullptr;
  }
  const std::lock_guard lock(mutex_);
  closed_ = true;
  next_.clear();
  for (const auto& [id, task] : open_)
    task->cancelled = task->abandoned = true;
}

void PageJobs::receive(std::string_view text) {
  auto task = std::make_shared<Task>();
  std::int64_t id = -1;
  try {
    task->request = decode_request(text);
    id = task->request.id;
    if (task->request.type == "cancel") {
      const Arguments request(task->request.body);
      return cancel(std::int64_t(request.number("of", 0, 9e15)), id);
    }
    task->handler = &find_handler(task->request.type);
    std::shared_ptr<Task> replaced;
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return;
      if (open_.count(id))
        throw Error(fmt::format("request {} is under way already: each needs a new id", id));
      if (open_.size() >= most_open) throw Error("too many requests at once: wait for answers");
      if (task->handler->pace == Pace::slow && slow_ >= most_slow)
        throw Error(fmt::format("{} long works are under way already: cancel one first", most_slow));
      const std::string& slot = task->request.slot;
      const bool waits = task->handler->pace == Pace::latest && !slot.empty() && busy_.count(slot);
      open_[id] = task;
      if (task->handler->pace == Pace::slow) ++slow_;
      if (waits) {
        std::swap(next_[slot], task);
        replaced = std::move(task);
        if (replaced) open_.erase(replaced->request.id);
      } else if (task->handler->pace == Pace::latest && !slot.empty()) {
        busy_[slot] = true;
      }
    }
    if (replaced) say(encode_cancelled(replaced->request.id));
    if (!task) return;
    if (task->is_slow())
      run_slow(task);
    else
      begin(task);
  } catch (const Error& e) {
    say(encode_error(id >= 0 ? id : id_of_malformed(text), e.what()));
  }
}

void PageJobs::begin(std::shared_ptr<Task> task) {
  {
    const std::lock_guard lock(mutex_);
    Lane& lane = lane_of(*task);
    if (lane.running == lane.most) {
      lane.waiting.push_back(std::move(task));
      return;
    }
    ++lane.running;
  }
  jobs_.enqueue([self = shared_from_this(), task] { self->run(task); });
}

void PageJobs::run_slow(std::shared_ptr<Task> task) {
  jobs_.began_slow();
  try {
    std::thread([self = shared_from_this(), task]() mutable {
      Jobs& jobs = self->jobs_;
      self->run(task);
      task.reset();
      self.reset();
      jobs.ended_slow();
    }).detach();
  } catch (const std::system_error&) {
    jobs_.ended_slow();
    {
      const std::lock_guard lock(mutex_);
      open_.erase(task->request.id);
      --slow_;
    }
    say(encode_error(task->request.id, "no thread can be started for it"));
  }
}

void PageJobs::cancel(std::int64_t of, std::int64_t id) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = open_.find(of); found != open_.end()) found->second->cancel();
  }
  // What ended in the meantime was answered already.
  say(encode(id, {}));
}

void PageJobs::run(const std::shared_ptr<Task>& task) {
  const std::int64_t id = task->request.id;
  const bool slow = task->is_slow();
  Message last;
  try {
    if (task->cancelled) {
      last = encode_cancelled(id);
    } else {
      Workshop& shop = jobs_.workshop_;
      Desk desk{shop.folder, shop.materials, pictures_, shop.start, id, &task->cancelled, {}};
      if (slow)
        desk.on_progress = [&](double share, const Answer& answer) {
          if (task->cancelled) return;
          Answer told = answer;
          told.header["progress"] = share;
          say(encode(id, told), true);
        };
      const OwnLoops own(slow ? OwnLoops::Priority::normal : OwnLoops::Priority::urgent);
      const Cancellation cancellation(task->abandoned);
      Answer answer = task->handler->answer(Arguments(task->request.body), desk);
      if (task->cancelled) answer.header["cancelled"] = true;
      last = encode(id, answer);
    }
  } catch (const std::bad_alloc&) {
    last = encode_error(id, "not enough memory for this request");
  } catch (const std::exception& e) {
    last = task->abandoned ? encode_cancelled(id) : encode_error(id, e.what());
  }
  std::shared_ptr<Task> next, waiting_for_a_thread;
  {
    const std::lock_guard lock(mutex_);
    open_.erase(id);
    if (slow) --slow_;
    if (Lane& lane = lane_of(*task); !slow && lane.waiting.empty()) {
      --lane.running;
    } else if (!slow) {
      waiting_for_a_thread = std::move(lane.waiting.front());
      lane.waiting.pop_front();
    }
    const std::string& slot = task->request.slot;
    if (task->handler->pace == Pace::latest && !slot.empty()) {
      if (const auto waiting = next_.find(slot); waiting != next_.end()) {
        next = waiting->second;
        next_.erase(waiting);
      } else {
        busy_.erase(slot);
      }
    }
  }
  say(std::move(last));
  if (waiting_for_a_thread)
    jobs_.enqueue([self = shared_from_this(), waiting_for_a_thread] { self->run(waiting_for_a_thread); });
  if (next) begin(next);
}

Jobs::Jobs(Workshop& workshop, int at_once) : workshop_(workshop), at_once_(std::max(at_once, 1)) {}

Jobs::~Jobs() {
  {
    std::unique_lock lock(mutex_);
    ending_ = true;
    queue_.clear();
    changed_.notify_all();
    changed_.wait(lock, [&] { return slow_ == 0; });
  }
  for (std::thread& t : threads_)
    t.join();
}

std::shared_ptr<PageJobs> Jobs::open(PageJobs::Send send) {
  return std::make_shared<PageJobs>(*this, std::move(send));
}

void Jobs::enqueue(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  if (ending_) return;
  queue_.push_back(std::move(work));
  // Pages limit what they ask for at once, so that this ends.
  try {
    if (idle_ < queue_.size()) threads_.emplace_back([this] { this->work(); });
  } catch (const std::system_error&) {
    // Those that are there do it, if there is one.
    if (threads_.empty()) throw Error("no thread can be started for this request");
  }
  changed_.notify_one();
}

void Jobs::began_slow() {
  const std::lock_guard lock(mutex_);
  ++slow_;
}

void Jobs::ended_slow() {
  const std::lock_guard lock(mutex_);
  --slow_;
  changed_.notify_all();
}

void Jobs::work() {
  for (;;) {
    std::function<void()> work;
    {
      std::unique_lock lock(mutex_);
      ++idle_;
      changed_.wait(lock, [&] { return ending_ || !queue_.empty(); });
      --idle_;
      if (ending_) return;
      work = std::move(queue_.front());
      queue_.pop_front();
    }
    work();
  }
}

} // namespace nacre
