//! The outcomes of jobs. Results come from the server's cache or else from a worker, with further attempts where these
//! may help.

use super::action::{Action, assemble};
use super::error::RemoteError;
use super::execute::{cached_result, execute};
use super::group::Group;
use super::results::{Sent, collect};
use super::server::Remote;
use crate::remote::{JobFailure, JobRequest, Origin, Outcome};

/// The origin of results, and for each job the reason why it failed, if it did.
type Results = (Origin, Vec<Option<JobFailure>>);

impl Remote {
    /// Returns the outcomes of the jobs of `group`. Calls `running` when a worker begins.
    pub(super) async fn outcomes(
        &self,
        request: &JobRequest<'_>,
        group: &Group<'_>,
        running: &(dyn Fn() + Sync),
    ) -> Vec<Outcome> {
        let mut moved = Vec::with_capacity(group.len());
        for (_, job) in group {
            moved.push((request.check)(job).and_then(|()| job.moved()));
        }
        let pairs = group.iter().zip(&moved);
        let sent: Vec<Sent<'_>> =
            pairs.filter_map(|((_, job), moved)| Some(Sent { job, moved: moved.as_ref().ok()? })).collect();
        let results = self.results(request, &sent, running).await;
        let mut outcomes = Vec::with_capacity(sent.len());
        match results {
            // If a job kills the tool, each job runs alone, so that the other jobs of the group do not fail with it.
            Err(RemoteError::Tool { .. }) if sent.len() > 1 => {
                for sent in sent.chunks(1) {
                    outcomes.extend(outcomes_of(self.results(request, sent, running).await, 1));
                }
            }
            results => outcomes.extend(outcomes_of(results, sent.len())),
        }
        let mut outcomes = outcomes.into_iter();
        let of_job = |moved| match moved {
            Ok(_) => outcomes.next().unwrap_or_else(|| Err(JobFailure::from(&RemoteError::NoOutputs))),
            Err(error) => Err(JobFailure::from(&error)),
        };
        moved.into_iter().map(of_job).collect()
    }

    async fn results(
        &self,
        request: &JobRequest<'_>,
        sent: &[Sent<'_>],
        running: &(dyn Fn() + Sync),
    ) -> Result<Results, RemoteError> {
        if let Some(error) = self.unreachable.get() {
            return Err(error.clone());
        }
        if sent.is_empty() {
            return Ok((Origin::Cached, Vec::new()));
        }
        let moved: Vec<_> = sent.iter().map(|sent| sent.moved).collect();
        let action = assemble(&moved, &self.tool, &self.options, &self.digests)?;
        let limit = self.options.timeout.unwrap_or(DEFAULT_TIMEOUT);
        let results = tokio::time::timeout(limit, self.run_action(request, sent, &action, running)).await;
        let results = results.unwrap_or(Err(RemoteError::Late { limit }));
        if let Err(error) = &results
            && error.is_unreachable()
        {
            // If another thread was first, its error is kept.
            let _ = self.unreachable.set(error.clone());
        }
        results
    }

    async fn run_action(
        &self,
        request: &JobRequest<'_>,
        sent: &[Sent<'_>],
        action: &Action,
        running: &(dyn Fn() + Sync),
    ) -> Result<Results, RemoteError> {
        let client = &self.client;
        client.count(|counts| counts.actions += 1);
        let mut skip_cache = false;
        if let Some(result) = client.attempts().at(|| cached_result(action.digest, client)).await? {
            match collect(&result, sent, request.disk_cache, client).await {
                Ok(failures) if !failures.iter().flatten().any(|failure| failure.is_transient) => {
                    client.count(|counts| counts.cached += 1);
                    return Ok((Origin::Cached, failures));
                }
                Err(error @ RemoteError::Cache(_)) => return Err(error),
                // Blobs are missing, a failure is transient, or the result is unusable: a worker makes another result.
                _ => skip_cache = true,
            }
        }
        let mut attempts = client.attempts();
        loop {
            let error = match self.execute_action(request, sent, action, &mut skip_cache, running).await {
                Ok(results) => return Ok(results),
                Err(error) => error,
            };
            if error.is_missing() {
                self.uploads.forget(&action.blobs);
            }
            attempts.after(error).await?;
        }
    }

    async fn execute_action(
        &self,
        request: &JobRequest<'_>,
        sent: &[Sent<'_>],
        action: &Action,
        skip_cache: &mut bool,
        running: &(dyn Fn() + Sync),
    ) -> Result<Results, RemoteError> {
        let client = &self.client;
        self.uploads.send(&action.blobs, client).await?;
        let response = execute(action.digest, *skip_cache, client, running).await?;
        // If this result is unusable, the next attempt must not get it from the server's cache.
        *skip_cache = true;
        let origin = if response.cached_result { Origin::Cached } else { Origin::Executed };
        client.count(|counts| match origin {
            Origin::Cached => counts.cached += 1,
            Origin::Executed => counts.executed += 1,
        });
        let result = response.result.unwrap_or_default();
        let failures = collect(&result, sent, request.disk_cache, client).await?;
        Ok((origin, failures))
    }
}

/// Time limit of an action if the caller sets none.
const DEFAULT_TIMEOUT: std::time::Duration = std::time::Duration::from_secs(3600);

/// Returns the outcomes of `jobs` jobs from their common result.
fn outcomes_of(results: Result<Results, RemoteError>, jobs: usize) -> Vec<Outcome> {
    match results {
        Ok((origin, failures)) => failures.into_iter().map(|failure| failure.map_or(Ok(origin), Err)).collect(),
        Err(error) => (0..jobs).map(|_| Err(JobFailure::from(&error))).collect(),
    }
}

impl From<&RemoteError> for JobFailure {
    fn from(error: &RemoteError) -> Self {
        Self { message: error.to_string(), is_transient: error.is_transient() }
    }
}
