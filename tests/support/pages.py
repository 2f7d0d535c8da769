# SPDX-License-Identifier: BSD-3-Clause
"""What pages of --report hold."""
import base64
import json
import re
import zlib


def data_of(page):
    """The data of a page, from its file: a zlib stream in base 64 of JSON, and, behind a byte 0,
    binary values of which the JSON has [number of the first byte, how many]."""
    held = re.search(r'<script id="data"[^>]*>(.*?)</script>', page.read_text(), re.DOTALL)
    text = zlib.decompress(base64.b64decode(held.group(1), validate=True))
    return json.loads(text.partition(b"\0")[0])
