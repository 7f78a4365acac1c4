# SPDX-License-Identifier: MIT
"""How long a status request takes, seen from a process of its own that does nothing else: prober.py URL SECONDS RATE.

Prints a JSON list of milliseconds, one for each request that was answered; those that a kill cut off are not counted.
"""

import http.client
import json
import sys
import time
import urllib.parse


def probe(url: str, seconds: float, rate: float) -> tuple[list[float], int]:
    address = urllib.parse.urlsplit(url)
    connection = http.client.HTTPConnection(address.hostname or "", address.port, timeout=30)
    taken: list[float] = []
    lost, job, begun = 0, "", time.monotonic()
    while (at := time.monotonic()) - begun < seconds:
        try:
            connection.request("GET", f"/v1/jobs/{job}" if job else "/v1/jobs?limit=1")
            reply = connection.getresponse()
            body = json.loads(reply.read())
            if job and reply.status == 200:
                taken.append((time.monotonic() - at) * 1000)
            if not job or body.get("state") in ("done", "failed"):
                connection.request("GET", "/v1/jobs?limit=1")  # the newest, which is being worked at
                jobs = json.loads(connection.getresponse().read()).get("jobs", [])
                job = jobs[0]["id"] if jobs else ""
        except (OSError, http.client.HTTPException, ValueError):
            lost += 1
            connection.close()
        time.sleep(max(0.0, at + 1 / rate - time.monotonic()))
    return taken, lost


if __name__ == "__main__":
    milliseconds, cut_off = probe(sys.argv[1], float(sys.argv[2]), float(sys.argv[3]))
    print(json.dumps({"milliseconds": milliseconds, "cut_off": cut_off}))
