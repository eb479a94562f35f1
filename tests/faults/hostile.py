"""Peers that mean harm: hostile.py PORT SECONDS SEED PID [--replay PORT]. Attacks the stream's receiver PID at PORT on TCP's,
ZeroMQ's (ZMTP 3.0, by hand) and the stream's own layer (host/sources/wire.h), and watches what it holds meanwhile. With
--replay an honest sender comes through there, who is waited for, and what it said is said again by others, late, twice and
in another order.
Prints one line: attacks by kind; the receiver's memory at first, at most and at the end, MB; its files and sockets at most."""
import argparse
import os
import random
import socket
import struct
import threading
import time

GREETING = b"\xff" + bytes(8) + b"\x7f\x03\x00" + b"NULL".ljust(20, b"\0") + bytes(32)
CURVE = GREETING.replace(b"NULL\0", b"CURVE")
READY = b"\x04\x1c\x05READY\x0bSocket-Type\x00\x00\x00\x06DEALER"
HEADER = struct.Struct("<IHHQQIIIIII7dQ")  # wire::Header
FIELDS = dict(magic=0x46534F52, version=1, type=1, session=0, sequence=0, flags=0, depth_bytes=0, colour_bytes=0, width=160,
              height=120, reserved=0, timestamp=0.0, seconds_per_stamp=1.0, fx=80.0, fy=80.0, cx=79.5, cy=59.5,
              units=5000.0, frames=0)
MIB = 1 << 20


def framed(body, more=False, announced=None):
    size = len(body) if announced is None else announced
    flags = int(more) | (2 if size > 255 else 0)
    return bytes([flags]) + (struct.pack(">Q", size) if size > 255 else bytes([size])) + body


def packed(random_, body=b"", **changes):
    values = {**FIELDS, "session": random_.getrandbits(64), **changes}
    return HEADER.pack(*values.values()) + body


class Peer:
    """One connection; what fails on it is the receiver's good right."""

    def __init__(self, port, greeting=GREETING, ready=True):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=5)
        if greeting:
            self.say(greeting)
            if ready:
                self.hear(64)
                self.say(READY)

    def say(self, data):
        self.socket.sendall(data)

    def hear(self, size):
        return self.socket.recv(size)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()


class Replay:
    """Between an honest sender and the receiver; keeps the last of what the sender said."""

    def __init__(self, listen, port):
        self.port, self.kept = port, []
        self.server = socket.create_server(("127.0.0.1", listen))
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            client = self.server.accept()[0]
            server = socket.create_connection(("127.0.0.1", self.port))
            for a, b, keep in ((client, server, True), (server, client, False)):
                threading.Thread(target=self.hand_on, args=(a, b, keep), daemon=True).start()

    def hand_on(self, a, b, keep):
        said = b""
        try:
            while data := a.recv(1 << 16):
                b.sendall(data)
                if keep:
                    said = self.messages(said + data)
        except OSError:
            pass
        for end in (a, b):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def messages(self, said):
        """Keeps whole frames, the greeting and commands left out; of an encrypted stream they are all that can be kept."""
        if said.startswith(b"\xff"):
            said = said[64:] if len(said) >= 64 else said
            if said.startswith(b"\xff"):
                return said
        while len(said) >= 2:
            long = said[0] & 2
            if long and len(said) < 9:
                break
            head = 9 if long else 2
            size = struct.unpack(">Q", said[1:9])[0] if long else said[1]
            if len(said) < head + size:
                break
            if not said[0] & 4:
                self.kept.append(said[:head + size])
                del self.kept[:-200]
            said = said[head + size:]
        return said


class Attacks:
    def __init__(self, port, end, replay):
        self.port, self.end, self.replay = port, end, replay

    def hold(self, seconds):
        time.sleep(max(0, min(seconds, self.end - time.time())))

    def random_bytes(self, r):
        with Peer(self.port, r.choice([b"", GREETING])) as peer:
            for _ in range(r.randrange(1, 5)):
                peer.say(r.randbytes(r.randrange(1, 20000)))

    def other_protocols(self, r):
        with Peer(self.port, b"") as peer:
            peer.say(r.choice([b"GET / HTTP/1.1\r\nHost: x\r\n\r\n", b"\x16\x03\x01\x02\x00\x01", GREETING[:10] + b"\x01\x05",
                               CURVE + b"\x04\xc8\x05HELLO" + r.randbytes(194)]))
            peer.hear(100)
            self.hold(0.2)

    def lying_sizes(self, r):
        with Peer(self.port) as peer:
            peer.say(framed(r.randbytes(100), announced=r.choice([2**63, 2**40, 65 * MIB, 64 * MIB, 2**20, 2**64 - 1])))
            self.hold(0.3)

    def lying_headers(self, r):
        lies = [dict(width=2**31 - 1, height=2**31 - 1), dict(width=4096, height=4096, type=2, depth_bytes=50),
                dict(depth_bytes=2**32 - 1, colour_bytes=2**32 - 1), dict(type=9), dict(version=2), dict(fx=float("nan")),
                dict(timestamp=float("inf")), dict(flags=2), dict(frames=2**64 - 1, sequence=2**64 - 1), dict(units=0.0),
                dict(type=2, sequence=2**63, depth_bytes=50), dict(type=3), dict(type=1, flags=1)]
        with Peer(self.port) as peer:
            for _ in range(20):
                lie = r.choice(lies)
                body = b"" if r.random() < 0.3 else r.randbytes(min(lie.get("depth_bytes", 0), 50))
                peer.say(framed(packed(r, body, **lie)))

    def large_messages(self, r):
        with Peer(self.port) as peer:
            peer.say(framed(b"", announced=60 * MIB))
            for _ in range(r.randrange(10, 59)):
                peer.say(bytes(MIB))
            self.hold(2)

    def endless_messages(self, r):
        with Peer(self.port) as peer:
            part = framed(bytes(1 << 16), more=True)
            for _ in range(r.randrange(100, 3000)):
                peer.say(part)

    def flood(self, r):
        with Peer(self.port) as peer:
            many = b"".join(framed(packed(r, width=8 + r.randrange(1000))) for _ in range(500))
            for _ in range(20):
                peer.say(many)

    def slow(self, r):
        peers = []
        try:
            for _ in range(10):
                peers.append(Peer(self.port, b""))
            for byte in GREETING + READY + framed(packed(r)):
                for peer in peers:
                    peer.say(bytes([byte]))
                self.hold(0.2)
        finally:
            for peer in peers:
                peer.socket.close()

    def half_open(self, r):
        peers = []
        try:
            for _ in range(100):
                peers.append(Peer(self.port, r.choice([b"", GREETING]), ready=False))
            self.hold(r.uniform(1, 10))
        finally:
            for peer in peers:
                peer.socket.close()

    def come_and_go(self, r):
        for _ in range(100):
            with Peer(self.port, b"") as peer:
                if r.random() < 0.5:  # reset
                    peer.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))

    def replayed(self, r):
        kept = list(self.replay.kept) if self.replay else []
        if not kept:
            return self.hold(0.2)
        r.shuffle(kept)
        with Peer(self.port) as peer:
            for message in kept[:50]:
                for _ in range(r.randrange(1, 3)):
                    peer.say(message)
            self.hold(0.2)


def measure(pid):
    with open(f"/proc/{pid}/status") as status:
        memory = next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1000
    return memory, len(os.listdir(f"/proc/{pid}/fd"))


def main():
    parser = argparse.ArgumentParser()
    for name in ("port", "seconds", "seed", "pid"):
        parser.add_argument(name, type=int)
    parser.add_argument("--replay", type=int)
    parser.add_argument("--only", nargs="*")
    o = parser.parse_args()
    end = time.time() + o.seconds
    attacks = Attacks(o.port, end, Replay(o.replay, o.port) if o.replay else None)
    kinds = o.only if o.only is not None else [name for name, kind in vars(Attacks).items() if not name.startswith("_") and name != "hold"]
    done = dict.fromkeys(kinds, 0)

    def work(name, number):
        random_ = random.Random(f"{o.seed} {name} {number}")
        while time.time() < end:
            try:
                getattr(attacks, name)(random_)
            except OSError:
                time.sleep(0.05)
            done[name] += 1

    threads = [threading.Thread(target=work, args=(name, number), daemon=True) for name in kinds for number in range(2)]
    while o.replay and not attacks.replay.kept and time.time() < end:  # without keys the first to come has the stream
        time.sleep(0.1)
    first, files = measure(o.pid)
    most, last = first, first
    for thread in threads:
        thread.start()
    while time.time() < end:
        time.sleep(0.1)
        try:
            last, now = measure(o.pid)
        except (OSError, StopIteration):
            print("the receiver is gone")
            break
        most, files = max(most, last), max(files, now)
    print(", ".join(f"{count} {name}" for name, count in done.items()) +
          f"; memory {first:.0f} at first, {most:.0f} at most, {last:.0f} MB at the end; {files} files and sockets at most")


main()
