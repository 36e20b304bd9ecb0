"""A WebSocket client (RFC 6455) on the standard library, for tests of the live view and for measurements."""

import base64
import json
import os
import re
import socket
import struct


def split(address):
    """Returns host, port and path of an address that the program prints."""
    host, port, path = re.fullmatch(r"http://([0-9.]+):(\d+)(/.*)", address).groups()
    return host, int(port), path


class Refused(Exception):
    """The server answered the request for a WebSocket with another status."""


class WebSocket:
    """The stream of a live view. Messages are str or bytes."""

    def __init__(self, address, host=None, origin=None, receive_buffer=None):
        name, port, path = split(address)
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(60)
        self.socket.connect((name, port))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {path}stream HTTP/1.1\r\nHost: {host or f'{name}:{port}'}\r\nUpgrade: websocket\r\n"
                             f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                             f"Origin: {origin or f'http://{name}:{port}'}\r\n\r\n").encode())
        self.bytes = bytearray()
        while b"\r\n\r\n" not in self.bytes:
            self.fill()
        head, _, self.bytes = self.bytes.partition(b"\r\n\r\n")
        status = head.split(b"\r\n")[0].decode()
        if " 101 " not in status:
            self.close()
            raise Refused(status)

    def fill(self):
        more = self.socket.recv(1 << 20)
        if not more:
            raise ConnectionError("the server has closed the connection")
        self.bytes += more

    def take(self, count):
        while len(self.bytes) < count:
            self.fill()
        taken = bytes(self.bytes[:count])
        del self.bytes[:count]
        return taken

    def next(self):
        """Returns the next message, and None at the end. Answers pings."""
        message = b""
        while True:
            first, length = self.take(2)
            if length == 126:
                length, = struct.unpack(">H", self.take(2))
            elif length == 127:
                length, = struct.unpack(">Q", self.take(8))
            data = self.take(length)
            code = first & 15
            if code == 8:
                return None
            if code == 9:
                self.send(10, data)
            elif code in (0, 1, 2):
                text = code == 1 if code else text
                message += data
                if first & 128:
                    return message.decode() if text else message

    def next_text_with(self, field):
        """Skips messages until a text has the field, and returns the field."""
        while True:
            message = self.next()
            if message is None:
                raise ConnectionError(f"the stream ended before {field}")
            if isinstance(message, str) and field in json.loads(message):
                return json.loads(message)[field]

    def send(self, code, data):
        self.socket.sendall(bytes((128 | code, 128 | len(data))) + bytes(4) + data)  # masked by zero

    def press(self, key):
        self.send(1, key.encode())

    def close(self):
        self.socket.close()
