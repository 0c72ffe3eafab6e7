//! What a tab holds, and tabs that are slow or gone.

use serde_json::{Value, json};

use super::driver::{Browser, Tab};

/// Looks at a tab: two states do not come in so little time.
const LOOKS: usize = 3;

/// What a tab holds, with all collected that nobody needs any more.
#[derive(Debug, Clone, Copy)]
pub struct Held {
    /// Objects of its script, kB.
    pub heap_kb: f64,
    /// Nodes of its documents, with those that only its script still knows.
    pub nodes: f64,
    /// What waits for events.
    pub listeners: f64,
}

impl Browser {
    /// What a tab holds: the least of some looks, as a state may come between the collection and a look.
    #[track_caller]
    pub fn held(&mut self, tab: &Tab) -> Held {
        let looks = [(); LOOKS].map(|()| self.held_now(tab));
        let least = looks
            .into_iter()
            .min_by(|a, b| a.heap_kb.total_cmp(&b.heap_kb));
        least.expect("there are some")
    }

    #[track_caller]
    fn held_now(&mut self, tab: &Tab) -> Held {
        for part in ["HeapProfiler.collectGarbage", "Performance.enable"] {
            self.ask(Some(tab), part, &json!({}));
        }
        let answer = self.ask(Some(tab), "Performance.getMetrics", &json!({}));
        let metrics = answer["result"]["metrics"].as_array().expect("metrics");
        let metric = |name: &str| {
            let found = metrics.iter().find(|metric| metric["name"] == name);
            found
                .and_then(|metric| metric["value"].as_f64())
                .expect(name)
        };
        Held {
            heap_kb: metric("JSHeapUsedSize") / 1024.0,
            nodes: metric("Nodes"),
            listeners: metric("JSEventListeners"),
        }
    }

    /// Makes a tab slow: so many bytes a second reach it, and its processor is `factor` times slower.
    #[track_caller]
    pub fn slow_down(&mut self, tab: &Tab, bytes_per_s: f64, factor: f64) {
        let network = json!({
            "offline": false,
            "latency": 100,
            "downloadThroughput": bytes_per_s,
            "uploadThroughput": bytes_per_s,
        });
        for (method, params) in [
            ("Network.enable", json!({})),
            ("Network.emulateNetworkConditions", network),
            ("Emulation.setCPUThrottlingRate", json!({ "rate": factor })),
        ] {
            let answer = self.ask(Some(tab), method, &params);
            assert_eq!(answer["error"], Value::Null, "{method}");
        }
    }

    /// Closes a tab.
    #[track_caller]
    pub fn close(&mut self, tab: &Tab) {
        let answer = self.ask(
            None,
            "Target.closeTarget",
            &json!({ "targetId": tab.target }),
        );
        assert_eq!(answer["error"], Value::Null);
    }
}
