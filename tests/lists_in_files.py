# SPDX-License-Identifier: LGPL-2.1-or-later
"""Files with a list of streams in them, and a server that nobody may connect to."""
import os
import socket


class Listed:
    """The server that the list names, until the test case ends."""

    def __init__(self, case):
        self.listener = socket.create_server(("127.0.0.1", 0))
        case.addCleanup(self.listener.close)
        self.address = f"http://127.0.0.1:{self.listener.getsockname()[1]}"
        self.text = f"#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\n{self.address}/a.ts\n#EXT-X-ENDLIST\n".encode()

    def write(self, folder):
        """The names of files with the list, behind a tag and in parts, that it writes to a folder."""
        part = b"--b\r\nContent-Type: application/x-hls\r\nContent-Length: %d\r\n\r\n%s\r\n" % (len(self.text), self.text)
        files = {"id3.mp4": b"ID3\x04\0\0\0\0\0\0" + self.text, "parts.mp4": 3 * part + b"--b--\r\n"}
        for name, content in files.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(content)
        return list(files)

    def expect_no_connection(self, case):
        self.listener.setblocking(False)
        with case.assertRaises(BlockingIOError):
            self.listener.accept()
