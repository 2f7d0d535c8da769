# SPDX-License-Identifier: BSD-3-Clause
"""What pages of --report hold."""
import base64
import json
import re
import zlib


def data_of(page):
    """The data of a page, from its file: JSON as a zlib stream in base 64."""
    held = re.search(r'<script id="data"[^>]*>(.*?)</script>', page.read_text(), re.DOTALL)
    return json.loads(zlib.decompress(base64.b64decode(held.group(1), validate=True)))
